#include "scene/file_finder.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/text.h"
#include "scene/json_reader.h"
#include "scene/names.h"

namespace castray {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return fs::exists(status) && !fs::is_directory(status);
}

fs::path file_named_by(const JsonNode& node, std::string_view name, const fs::path& scene_file) {
  const std::string& text = read_string(node, name);
  if (text.find('\0') != text.npos)
    throw InputError(node.place, fmt::format("{} must not hold a zero byte", name));
  fs::path path = scene_file.parent_path() / text;
  if (is_file(path)) return path;
  std::error_code ignored;
  throw InputError(
      node.place,
      fmt::format("{}: {}", fs::is_directory(path, ignored) ? "a folder, not a file" : "no such file",
                  printable(path.string())));
}

const FileFinder::Listing& FileFinder::listing(const fs::path& folder) {
  const auto [found, is_new] = listings_.try_emplace(folder);
  if (!is_new) return found->second;
  std::error_code error;
  for (fs::directory_iterator entry(folder.empty() ? "." : folder, error), end; !error && entry != end;
       entry.increment(error))
    found->second.emplace(lower_case(entry->path().filename().string()), entry->path().filename());
  return found->second;
}

/// Part by part; each as it is written, else in letters of other case.
std::optional<fs::path> FileFinder::find_in(const fs::path& folder, std::string_view name) {
  fs::path path = folder;
  while (!name.empty()) {
    const std::size_t end = std::min(name.find('/'), name.size());
    const std::string part(name.substr(0, end));
    name.remove_prefix(std::min(end + 1, name.size()));
    if (part.empty() || part == ".") continue;
    if (part == "..") {
      path /= part;
      continue;
    }
    const Listing& files = listing(path);
    const auto found = files.find(lower_case(part));
    if (found == files.end()) return std::nullopt;
    std::error_code ignored;
    path /= fs::exists(path / part, ignored) ? fs::path(part) : found->second;
  }
  return is_file(path) ? std::optional(path) : std::nullopt;
}

std::optional<FileFinder::Found> FileFinder::find(std::string_view name, const fs::path& named_in) {
  constexpr std::size_t longest_path = 4096;
  if (name.empty() || name.size() > longest_path) return std::nullopt;
  const fs::path folder = named_in.parent_path();
  const std::vector<std::string> names = readings(name);
  for (const std::string& reading : names) {
    if (reading.empty()) continue;
    // A name without '/' is in the folder's list, or nowhere.
    if (reading.find_first_of("/") != std::string::npos && is_file(folder / reading))
      return Found{folder / reading, false};
    if (const auto path = find_in(folder, reading)) return Found{*path, false};
    std::string slashes = reading;
    std::ranges::replace(slashes, '\\', '/');
    if (const auto path = find_in(folder, slashes); path && slashes != reading) return Found{*path, false};
  }
  // As much of the path's end as is there: "textures/wood.png", else "wood.png".
  for (std::string reading : names) {
    std::ranges::replace(reading, '\\', '/');
    for (std::size_t slash = reading.find('/'); slash != std::string::npos;
         slash = reading.find('/', slash + 1))
      if (const auto path = find_in(folder, std::string_view(reading).substr(slash + 1)))
        return Found{*path, true};
  }
  return std::nullopt;
}

}  // namespace castray
