#include "plan/film_key.h"

#include <fmt/format.h>

#include <cstring>

#include "core/text.h"
#include "materials/descriptor.h"
#include "plan/option_names.h"

namespace castray {

namespace {

/// A 64-bit hash of all bytes given, in order (the mixing step of splitmix64 on each word).
class Hash {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::has_unique_object_representations_v<T> || std::is_floating_point_v<T>);
    add_bytes(&value, sizeof value);
  }
  void add(const Vec3d& v) { add(v.x), add(v.y), add(v.z); }
  template <class T>
  void add(const std::vector<T>& values) {
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(T));
  }
  std::uint64_t value() const { return state_; }

 private:
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (; size > 0; bytes += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      const std::size_t n = size < sizeof word ? size : sizeof word;
      std::memcpy(&word, bytes, n);
      state_ = mix(state_ ^ word) + 0x9e3779b97f4a7c15u;
      size -= n;
    }
  }

  static constexpr std::uint64_t mix(std::uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
  }

  std::uint64_t state_ = 0;
};

void add_map(Hash& hash, const TextureMap& map) {
  hash.add(map.texture);
  if (!map.used()) return;
  for (const float v : {map.scale[0], map.scale[1], map.offset[0], map.offset[1], map.base, map.gain})
    hash.add(v);
  hash.add(map.clamp);
  hash.add(map.channel);
  if (map.filter != TextureFilter::none) hash.add(map.filter);
}

void add_optics(Hash& hash, const Camera& camera) {
  hash.add(camera.tan_half_fov);
  if (camera.projection != Projection::perspective) hash.add(camera.projection), hash.add(camera.half_height);
  if (camera.shift_x != 0 || camera.shift_y != 0) hash.add(camera.shift_x), hash.add(camera.shift_y);
  if (const Lens& lens = camera.lens; camera.has_lens())
    hash.add(lens.radius), hash.add(lens.focus_distance), hash.add(lens.blades), hash.add(lens.rotation);
}

std::uint64_t view_hash(const Camera& camera) {
  Hash hash;
  for (const Vec3d& v : {camera.position, camera.forward, camera.right, camera.up}) hash.add(v);
  add_optics(hash, camera);
  return hash.value();
}

void add_light(Hash& hash, const DeltaLight& light) {
  hash.add(light.kind);
  for (const Vec3d& v : {light.position, light.direction, light.intensity}) hash.add(v);
  hash.add(light.cos_outer), hash.add(light.cos_inner);
}

void add_triangles(Hash& hash, const Scene& scene) {
  hash.add(scene.positions);
  hash.add(scene.triangles);
  hash.add(scene.triangle_material);
  hash.add(scene.normals);
  hash.add(scene.triangle_normals);
  hash.add(scene.uvs);
  hash.add(scene.triangle_uvs);
  hash.add(scene.colors);
  hash.add(scene.triangle_colors);
}

void add_instance(Hash& hash, const SceneInstance& instance, const SharedMesh& mesh) {
  hash.add(mesh.first), hash.add(mesh.count);
  for (const Vec3f& row : instance.rows) hash.add(Vec3d(row));
  hash.add(Vec3d(instance.translation));
}

void add_material(Hash& hash, const Material& m) {
  const Material usual;
  hash.add(m.type);
  for (const MaterialKey& key : descriptor_of(m.type).keys) {
    const bool has_map = key.parameter && m.map(*key.parameter).used();
    if (key.optional_in_hash && !has_map && value_of(key, m) == value_of(key, usual)) continue;
    hash.add(value_of(key, m));
    // Lobes got images after films were made.
    if (has_map || (key.parameter && *key.parameter < SurfaceParameter::anisotropy))
      add_map(hash, m.map(*key.parameter));
  }
  hash.add(m.correlated_masking);
  if (m.has_back()) hash.add(m.back);
  if (m.emits_backwards) hash.add(m.emits_backwards);
  if (m.has_index()) hash.add(m.eta), hash.add(m.k);
}

void add_texture(Hash& hash, const Texture& t) {
  hash.add(t.width), hash.add(t.channels), hash.add(t.color_space);
  hash.add(t.bytes), hash.add(t.floats);
}

}  // namespace

std::uint64_t scene_hash(const Scene& scene) {
  Hash hash;
  const Camera& camera = scene.camera;
  for (const Vec3d& v :
       {camera.position, camera.forward, camera.right, camera.up, scene.center, scene.environment})
    hash.add(v);
  if (const EnvironmentImage& image = scene.environment_image; image.used())
    hash.add(image.texture), hash.add(image.scale), hash.add(image.rotation);
  add_optics(hash, camera);
  hash.add(scene.unit);
  for (const DeltaLight& light : scene.delta_lights) add_light(hash, light);
  add_triangles(hash, scene);
  for (const SceneInstance& instance : scene.instances)
    add_instance(hash, instance, scene.shared_meshes[instance.mesh]);
  for (const Material& material : scene.materials) add_material(hash, material);
  for (const Texture& texture : scene.textures) add_texture(hash, texture);
  return hash.value();
}

std::string film_key(const SceneFacts& scene, const Job& job) {
  const RenderOptions& o = job.options;
  std::string key;
  const auto add = [&key](const char* name, const auto& value) {
    key += fmt::format("{}{}={}", key.empty() ? "" : "; ", name, value);
  };
  const auto number_or_auto = [](const std::optional<double>& number) {
    return number ? fmt::format("{}", *number) : std::string("auto");
  };
  add("scene", escape_item(scene.name));
  add("hash", fmt::format("{:016x}", scene.hash));
  add("size", fmt::format("{}x{}", job.window.full_width, job.window.full_height));
  add("seed", o.seed);
  add("integrator", o.integrator == Integrator::reference ? "reference" : "wavefront");
  add("precision", name_in(precision_names, o.precision));
  add("sampler", name_in(sampler_names, o.sampler));
  add("rr", number_or_auto(o.rr));
  add("max-depth", o.max_depth > 0 ? std::to_string(o.max_depth) : "none");
  add("epsilon", number_or_auto(o.epsilon));
  add("lights", name_in(light_sampling_names, o.lights));
  add("mis", name_in(switch_names, o.mis));
  add("jitter", o.jitter ? "on" : "off");
  add("reuse", o.reuse.automatic ? "auto"
               : o.reuse.width == 0
                   ? "off"
                   : fmt::format("{}x{}:{}", o.reuse.width, o.reuse.height, o.reuse.suffixes));
  if (o.camera) add("view", fmt::format("{:016x}", view_hash(*o.camera)));
  if (o.caustics != Switch::automatic) add("caustics", name_in(switch_names, o.caustics));
  if (o.reconstruct != Switch::automatic) add("reconstruct", name_in(switch_names, o.reconstruct));
  if (o.clamp_indirect) add("clamp-indirect", *o.clamp_indirect);
  if (o.target_error) add("target-error", *o.target_error);
  if (job.fault != Fault::none) add("fault", name_in(fault_names, job.fault));
  return key;
}

}  // namespace castray
