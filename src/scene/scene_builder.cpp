#include "scene/scene_builder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "castray/error.h"
#include "castray/image.h"
#include "core/range.h"
#include "core/text.h"
#include "materials/surface_values.h"

namespace castray {

namespace {

/// Gives what has no name that of its file.
void name_objects(Mesh& mesh, const std::string& file) {
  if (mesh.objects.empty() || mesh.objects.front().first_triangle > 0)
    mesh.objects.insert(mesh.objects.begin(), SceneObject{});
  for (SceneObject& object : mesh.objects)
    if (object.name.empty()) object.name = file;
}

void check_values(const std::vector<float>& values, TextureMeaning meaning,
                  const std::filesystem::path& file) {
  for (const float value : values) {
    if (!std::isfinite(value))
      throw InputError(SourcePlace{file.string()}, "a texture's values must be finite");
    if (value < 0 && meaning == TextureMeaning::amounts)
      throw InputError(SourcePlace{file.string()}, "a texture's values must be at least 0");
  }
}

/// Stores as (1 + n) / 2 what is stored as n.
void encode_normals(std::vector<float>& values) {
  if (std::ranges::none_of(values, [](float v) { return v < 0; })) return;
  for (float& value : values) value = (1 + value) / 2;
}

}  // namespace

std::uint16_t SceneBuilder::add_material(Material material) {
  constexpr std::size_t most = std::numeric_limits<std::uint16_t>::max();
  if (scene.materials.size() >= most)
    throw InputError(SourcePlace{scene.file.string()},
                     "more than " + std::to_string(most) + " materials; use fewer");
  scene.materials.push_back(std::move(material));
  return static_cast<std::uint16_t>(scene.materials.size() - 1);
}

int SceneBuilder::add_texture(const std::filesystem::path& file, ColorSpace space, TextureMeaning meaning) {
  return add_raster({file, -1}, file.filename().string(), space, meaning, [&] { return read_raster(file); });
}

int SceneBuilder::add_texture(const TextureSource& source, const std::string& name, std::string_view bytes,
                              ColorSpace space, TextureMeaning meaning) {
  return add_raster(source, name, space, meaning, [&] { return parse_raster(name, bytes); });
}

int SceneBuilder::add_raster(const TextureSource& source, const std::string& name, ColorSpace space,
                             TextureMeaning meaning, const std::function<Raster()>& read) {
  // Bytes are never below 0: they are the same whatever they mean.
  const std::string as_bytes =
      fmt::format("{}\n{} {}", source.file.string(), source.image, static_cast<int>(space));
  if (const auto found = textures_.find(as_bytes); found != textures_.end()) return found->second;
  const int index = add_texture(fmt::format("{} {}", as_bytes, static_cast<int>(meaning)), [&] {
    Raster raster = read();
    check_values(raster.floats, meaning, source.file);
    if (meaning == TextureMeaning::normals) encode_normals(raster.floats);
    Texture texture = make_texture(name, std::move(raster), space);
    texture.source = source;
    return texture;
  });
  if (!scene.textures[static_cast<std::size_t>(index)].bytes.empty()) textures_[as_bytes] = index;
  return index;
}

int SceneBuilder::add_texture(const std::string& name, const std::function<Texture()>& make) {
  if (const auto found = textures_.find(name); found != textures_.end()) return found->second;
  scene.textures.push_back(make());
  return textures_[name] = static_cast<int>(scene.textures.size()) - 1;
}

void SceneBuilder::ignore(const std::filesystem::path& file, std::string_view key) {
  constexpr std::size_t most = 100;
  const std::string text = file.string() + ": " + printable(key);
  if (scene.ignored_keys.size() < most &&
      std::ranges::find(scene.ignored_keys, text) == scene.ignored_keys.end())
    scene.ignored_keys.push_back(text);
}

std::size_t SceneBuilder::add_object() {
  objects_.emplace_back();
  return objects_.size() - 1;
}

void SceneBuilder::place(std::size_t object, const Transform& transform,
                         std::optional<std::uint16_t> material) {
  instances_.push_back({object, transform, material});
}

void SceneBuilder::add(Mesh&& mesh, const std::filesystem::path& file, std::optional<std::size_t> object) {
  if (mesh.triangles.empty()) {
    warnings.add({file.string()}, "has no faces");
    if (!without_faces_) without_faces_ = file;
  }
  name_objects(mesh, file.stem().string());
  drop_degenerate(mesh, file);
  if (object)
    join(objects_[*object], std::move(mesh));
  else
    add_to_scene(std::move(mesh));
}

void SceneBuilder::add_to_scene(Mesh&& mesh) {
  std::map<std::string, std::string> names;  // of this mesh's objects in the scene
  for (SceneObject& object : mesh.objects) {
    const auto [known, is_new] = names.try_emplace(object.name, object.name);
    while (is_new && object_names_.contains(known->second))
      known->second = fmt::format("{}.{:03}", object.name, object_names_[object.name]++);
    object.name = known->second;
  }
  for (const auto& [given, name] : names) object_names_.try_emplace(name, 1);
  join(mesh_, std::move(mesh));
}

void SceneBuilder::join(Mesh& all, Mesh&& more) const {
  if (all.positions.size() + more.positions.size() >= Scene::no_index ||
      all.triangles.size() + more.triangles.size() >= Scene::no_index)
    throw InputError(SourcePlace{scene.file.string()}, "more than 2^32 - 2 vertices or triangles; use fewer");
  append(all, std::move(more));
}

void SceneBuilder::warn_of_dropped(TriangleFault fault, const SourcePlace& place, std::uint64_t count) {
  if (count == 0) return;
  scene.dropped_triangles += count;
  if (fault == TriangleFault::no_area)
    warnings.add(place, "a triangle without area is left out", Harm::none, count);
  else
    warnings.add(
        place,
        fmt::format("a triangle is left out: a corner is nan, infinite or farther than {:g} from the "
                    "origin",
                    farthest_coordinate),
        Harm::changes_picture, count);
}

void SceneBuilder::drop_degenerate(Mesh& mesh, const std::filesystem::path& file) {
  std::vector<bool> keep(mesh.triangles.size());
  std::array<std::uint64_t, triangle_faults> dropped{};
  for (std::size_t t = 0; t < keep.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const auto fault = fault_of(mesh.positions[a], mesh.positions[b], mesh.positions[c]);
    keep[t] = !fault;
    if (fault) ++dropped[static_cast<std::size_t>(*fault)];
  }
  for (std::size_t i = 0; i < triangle_faults; ++i) {
    const SourcePlace& first = mesh.first_faults[i];
    warn_of_dropped(static_cast<TriangleFault>(i), first.file.empty() ? SourcePlace{file.string()} : first,
                    dropped[i]);
  }
  keep_triangles(mesh, keep);
  drop_unused(mesh.positions, mesh.triangles);
}

}  // namespace castray
