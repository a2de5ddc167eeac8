#include "cli/image_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "castray/error.h"
#include "castray/image.h"
#include "core/text.h"

namespace castray::cli {

std::set<std::string> images_below(const std::filesystem::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  for (std::filesystem::recursive_directory_iterator at(folder, error), end; !error && at != end;
       at.increment(error))
    if (at->is_regular_file() && is_image_format(at->path()) && !is_variance_file(at->path()))
      names.insert(std::filesystem::relative(at->path(), folder).generic_string());
  if (error) throw InputError({folder.string()}, "cannot be read: " + error.message());
  if (names.empty()) throw InputError({folder.string()}, "holds no images");
  return names;
}

std::string size_text(const std::filesystem::path& folder) {
  const std::set<std::string> names = images_below(folder);
  double bytes = 0;
  for (const std::string& name : names)
    bytes += static_cast<double>(std::filesystem::file_size(folder / name));
  return fmt::format("{} image{}, {} MB", names.size(), names.size() == 1 ? "" : "s",
                     two_digits(std::max(bytes, 1e4) / 1e6));
}

}  // namespace castray::cli
