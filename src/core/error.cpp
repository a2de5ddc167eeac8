#include "castray/error.h"

namespace castray {

std::string placed(const SourcePlace& place, const std::string& message) {
  std::string text = place.file;
  if (place.line > 0) text += ":" + std::to_string(place.line);
  if (place.line > 0 && place.column > 0) text += ":" + std::to_string(place.column);
  return text.empty() ? message : text + ": " + message;
}

InputError::InputError(const SourcePlace& place, const std::string& message)
    : std::runtime_error(placed(place, message)) {}

}  // namespace castray
