#include "scene/obj_materials.h"

#include <fmt/core.h>

#include <algorithm>
#include <unordered_set>

#include "core/nearest.h"
#include "core/text.h"
#include "scene/mtl_material.h"
#include "scene/names.h"

namespace castray {

namespace {

bool ends_in_mtl(std::string_view text) {
  return text.size() >= 4 && lower_case(text.substr(text.size() - 4)) == ".mtl";
}

/// Takes the first name off "a.mtl my scene.mtl": up to its closing quote, to a word that ends in ".mtl", or
/// to the line's end.
std::string_view take_file_name(std::string_view& line) {
  std::size_t end = 0;
  if (line.front() == '"' && line.find('"', 1) != line.npos) {
    end = line.find('"', 1) + 1;
  } else {
    do end = std::min(line.find_first_of(" \t", end + 1), line.size());
    while (end < line.size() && !ends_in_mtl(line.substr(0, end)));
  }
  const std::string_view name = line.substr(0, end);
  line = trimmed(line.substr(end));
  return name;
}

std::vector<std::string_view> split_words(std::string_view text) {
  std::vector<std::string_view> words;
  while (!(text = trimmed(text)).empty()) {
    words.push_back(text.substr(0, text.find_first_of(" \t")));
    text.remove_prefix(words.back().size());
  }
  return words;
}

}  // namespace

/// The libraries of one OBJ file, while its "mtllib" lines are gone through.
class ObjMaterials::Search {
 public:
  Search(ObjMaterials& all, const ObjFile& obj) : all_(all), obj_(obj) {
    for (const NamedPlace& statement : obj.libraries) open_all(statement);
  }

  bool any_missing() const { return !missing_.empty(); }
  const std::vector<Library*>& found() const { return found_; }

  std::optional<std::uint16_t> material(std::string_view name) const {
    for (const std::string& reading : readings(name))
      if (const auto index = look_up(&Library::names, reading)) return index;
    if (const auto index = look_up(&Library::shortened, std::string(name))) return index;
    // Of "a #1" and "a #2" neither is meant by the other's name; of "a # one" and "a # two" both are a.
    for (const std::string_view shortened : without_comments(name))
      if (name.substr(shortened.size()).find("# ") != name.npos)
        if (const auto index = look_up(&Library::shortened, std::string(shortened))) return index;
    return std::nullopt;
  }

 private:
  using Names = std::unordered_map<std::string, std::size_t>;

  std::optional<std::uint16_t> look_up(Names Library::*names, const std::string& name) const {
    for (Library* library : found_)
      if (const auto known = (library->*names).find(name); known != (library->*names).end())
        return all_.use(*library, known->second, !obj_.mesh.colors.empty());
    return std::nullopt;
  }

  void open_all(const NamedPlace& statement) {
    WarningList& warnings = all_.builder_.warnings;
    std::string_view rest = without_comment(statement.name);
    if (open(statement.name, statement.place)) return;
    if (rest.empty()) warnings.add(statement.place, "mtllib without a file name", Harm::none);
    while (!rest.empty()) {
      const std::string_view name = take_file_name(rest);
      if (open(name, statement.place)) continue;
      const std::vector<std::string_view> words = split_words(name);
      std::vector<std::string_view> lost;
      for (const std::string_view word : words)
        if (words.size() == 1 || !open(word, statement.place)) lost.push_back(word);
      if (lost.size() == words.size()) lost = {name};
      for (const std::string_view file : lost)
        warnings.add(statement.place, fmt::format("mtllib: no such file: {}", printable(file)));
    }
  }

  bool open(std::string_view name, const SourcePlace& place) {
    if (missing_.contains(std::string(name))) return false;
    const auto file = all_.builder_.files.find(name, obj_.path);
    if (!file) {
      missing_.emplace(name);
      return false;
    }
    if (file->elsewhere)
      all_.builder_.warnings.add(
          place,
          fmt::format("mtllib: {} is not there; {} is read", printable(name), printable(file->path.string())),
          Harm::none);
    Library& library = all_.open(file->path);
    if (std::ranges::find(found_, &library) == found_.end()) found_.push_back(&library);
    return true;
  }

  ObjMaterials& all_;
  const ObjFile& obj_;
  std::vector<Library*> found_;
  std::unordered_set<std::string> missing_;
};

ObjMaterials::Library& ObjMaterials::open(const std::filesystem::path& file) {
  const auto [found, is_new] = libraries_.try_emplace(file.lexically_normal());
  Library& library = found->second;
  if (!is_new) return library;
  library.file = read_mtl(file, builder_.warnings);
  for (auto& indices : library.indices) indices.resize(library.file.materials.size());
  for (std::size_t i = 0; i < library.file.materials.size(); ++i) {
    const std::string& name = library.file.materials[i].name;
    for (const std::string& spelling : spellings(name)) library.names.emplace(spelling, i);
    for (const std::string_view shortened : without_comments(name))
      for (const std::string& spelling : spellings(shortened)) library.shortened.emplace(spelling, i);
  }
  for (const std::string& key : library.file.ignored) builder_.ignore(file, key);
  return library;
}

std::uint16_t ObjMaterials::use(Library& library, std::size_t material, bool vertex_colors) {
  std::optional<std::uint16_t>& index = library.indices[vertex_colors][material];
  if (!index) index = add_material(library.file, library.file.materials[material], vertex_colors, builder_);
  return *index;
}

std::uint16_t ObjMaterials::default_material(bool vertex_colors) {
  std::optional<std::uint16_t>& index = default_[vertex_colors];
  Material material{.name = "default"};
  if (vertex_colors) material.kd = Vec3d(1.0), material.vertex_colors = true;
  if (!index) index = builder_.add_material(std::move(material));
  return *index;
}

std::string ObjMaterials::not_found(const std::string& name, const Search& search) {
  constexpr int most_suggestions = 20;  // each looks at every name that is known
  if (name.empty()) return "usemtl without a name";
  if (search.found().empty() && !search.any_missing()) return "usemtl, but no mtllib";
  if (search.any_missing()) return "usemtl of a material that is in no library that was found";
  std::vector<std::string_view> known;
  if (suggestions_++ < most_suggestions)
    for (const Library* library : search.found())
      for (const MtlMaterial& material : library->file.materials)
        if (!material.name.empty()) known.push_back(material.name);
  return fmt::format("material '{}' not found{}", printable(name),
                     known.empty() ? std::string() : suggestion(name, known));
}

std::vector<std::uint16_t> ObjMaterials::find_all(const ObjFile& obj, const ReplacedMaterials& replaced) {
  std::vector<std::string_view> known;
  std::optional<Search> opened;  // not where all materials are replaced
  if (replaced.empty()) opened.emplace(*this, obj);
  std::vector<std::uint16_t> indices;
  for (const ObjFile::UsedMaterial& used : obj.materials) {
    known.push_back(used.name);
    if (const auto other = replaced.find(used.name)) {
      indices.push_back(*other);
      continue;
    }
    if (!opened) opened.emplace(*this, obj);
    const auto found = used.named ? opened->material(used.name) : std::nullopt;
    if (used.named && !found)
      builder_.warnings.add(used.place, not_found(used.name, *opened) + "; the default, grey, is used");
    if (found && used.in_front)
      builder_.warnings.add(used.place, "usemtl in front of the mtllib that has the material", Harm::none);
    indices.push_back(found ? *found : default_material(!obj.mesh.colors.empty()));
  }
  replaced.warn_of_unknown(known, builder_.warnings);
  return indices;
}

}  // namespace castray
