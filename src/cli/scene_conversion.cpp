#include "cli/scene_conversion.h"

#include <fmt/core.h>

#include <algorithm>

#include "castray/error.h"
#include "castray/scene_files.h"
#include "cli/display_flags.h"
#include "core/files.h"

namespace castray::cli {

namespace {

namespace fs = std::filesystem;

/// Whether the file is there as it would be written. Throws InputError where it holds something else: a
/// scene file is worked on.
bool is_written(const SceneFiles::File& file) {
  check_writable(file.path);
  std::error_code ignored;
  if (!fs::exists(file.path, ignored)) return false;
  if (read_file(file.path) == file.bytes) return true;
  throw InputError({file.path.string()},
                   "is there, and other than what would be written; move it, or give -o another name");
}

}  // namespace

bool is_convertible_scene(const fs::path& file) {
  constexpr std::string_view suffixes[] = {".gltf", ".glb", ".obj", ".ply"};
  return std::ranges::find(suffixes, suffix_of(file)) != std::end(suffixes);
}

void convert_scene_file(const fs::path& input, const fs::path& output, const CommonFlags& common) {
  if (suffix_of(output) != ".json")
    throw InputError({output.string()}, "a scene becomes a scene file, whose name ends in .json");
  check_writable(output);
  SceneFiles files = convert_scene(input, output);
  if (!common.quiet)
    for (const SceneWarning& warning : files.warnings)
      if (!warning.harmless || common.verbose) fmt::print(stderr, "castray: warning: {}\n", warning.text());
  std::vector<SceneFiles::File> all = std::move(files.images);
  all.push_back(std::move(files.scene));  // last: it is there when all that it needs is
  std::erase_if(all, is_written);
  std::vector<fs::path> written;
  for (const SceneFiles::File& file : all) {
    write_file(file.path, file.bytes);
    written.push_back(file.path);
  }
  if (common.verbose) tell_written(written);
}

}  // namespace castray::cli
