#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "castray/image.h"

namespace castray {

/// Rows y0 <= y < y1 of an image.
using ImageRows = std::function<Image(int y0, int y1)>;

/// Writes an image that need never be in memory as a whole: `rows` makes `band` rows at a time, from the top,
/// once each. The bytes are those of `write_image`. `metadata` is asked for after the first rows. No file is
/// replaced unless all rows were made and written. Not to .film files, nor PFM to what cannot be written in
/// any order.
void write_image_in_bands(const std::vector<std::filesystem::path>& files, int width, int height, int band,
                          const ImageRows& rows, const Display& display,
                          const std::function<Metadata()>& metadata);

}  // namespace castray
