#pragma once

#include <filesystem>

namespace castray::cli {

/// Prints what an image or film holds, and its metadata.
void print_image_info(const std::filesystem::path& file);

}  // namespace castray::cli
