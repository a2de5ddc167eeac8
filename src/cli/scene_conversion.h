#pragma once

#include <filesystem>

#include "cli/common_flags.h"

namespace castray::cli {

/// Whether `castray convert` makes a scene file of such a file.
bool is_convertible_scene(const std::filesystem::path& file);

/// Writes the scene file `output` that shows what `input` does, and the images that it needs beside it.
/// Throws InputError before anything is written where a file is there already and holds something else.
void convert_scene_file(const std::filesystem::path& input, const std::filesystem::path& output,
                        const CommonFlags& common);

}  // namespace castray::cli
