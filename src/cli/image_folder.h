#pragma once

#include <filesystem>
#include <set>
#include <string>

namespace castray::cli {

/// The image files in and below a folder, by their paths from it. Throws InputError if there are none.
std::set<std::string> images_below(const std::filesystem::path& folder);

/// What the images below a folder take on the disk: "12 images, 3.4 MB".
std::string size_text(const std::filesystem::path& folder);

}  // namespace castray::cli
