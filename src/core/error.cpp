#include "castray/error.h"

namespace castray {

namespace {

std::string with_place(const SourcePlace& place, const std::string& message) {
  std::string text = place.file;
  if (place.line > 0) text += ":" + std::to_string(place.line);
  if (place.line > 0 && place.column > 0) text += ":" + std::to_string(place.column);
  return text.empty() ? message : text + ": " + message;
}

}  // namespace

InputError::InputError(const SourcePlace& place, const std::string& message)
    : std::runtime_error(with_place(place, message)) {}

}  // namespace castray
