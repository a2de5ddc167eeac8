#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "scene/json_document.h"

namespace castray {

/// Whether there is something at that path that is no folder.
bool is_file(const std::filesystem::path& path);

/// The file that a member of a scene file names, relative to the scene's folder. Throws InputError with the
/// node's place where there is none. `name` is what the message calls the member.
std::filesystem::path file_named_by(const JsonNode& node, std::string_view name,
                                    const std::filesystem::path& scene_file);

/// Finds the files that OBJ and MTL files name.
class FileFinder {
 public:
  struct Found {
    std::filesystem::path path;
    bool elsewhere;  ///< not where the name says, but under its last part beside the file that names it
  };

  /// The file that `name`, the end of a line in `named_in`, means: relative to the folder of `named_in`; with
  /// '/' or '\' between folders and letters of either case; else, wherever the name leads, what lies beside
  /// `named_in` under the last part of the name.
  std::optional<Found> find(std::string_view name, const std::filesystem::path& named_in);

 private:
  using Listing = std::map<std::string, std::filesystem::path>;  ///< of a folder, by name in lower case

  const Listing& listing(const std::filesystem::path& folder);
  std::optional<std::filesystem::path> find_in(const std::filesystem::path& folder, std::string_view name);

  std::map<std::filesystem::path, Listing> listings_;
};

}  // namespace castray
