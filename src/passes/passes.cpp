#include "castray/passes.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>

#include "core/threads.h"
#include "passes/camera_hits.h"
#include "passes/cryptomatte.h"
#include "plan/job.h"

namespace castray {

namespace {

std::size_t pixels_of(const Window& window) {
  return static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height());
}

/// Three channels that are filled in together; or none.
class VectorPass {
 public:
  VectorPass(bool wanted, Passes& passes, const std::string& layer, const char (&axes)[4], bool may_be_half,
             std::size_t pixels)
      : passes_(passes), first_(passes.channels.size()), wanted_(wanted) {
    for (int c = 0; wanted && c < 3; ++c)
      passes.channels.push_back(
          {fmt::format("{}.{}", layer, axes[c]), may_be_half, std::vector<float>(pixels)});
  }
  void set(std::size_t pixel, const Vec3d& value) const {
    for (std::size_t c = 0; wanted_ && c < 3; ++c)
      passes_.channels[first_ + c].values[pixel] = static_cast<float>(value[static_cast<int>(c)]);
  }

 private:
  Passes& passes_;
  std::size_t first_;
  bool wanted_;
};

std::vector<std::string> object_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const SceneObject& object : scene.objects) names.push_back(object.name);
  return names;
}

std::vector<std::string> material_names(const Scene& scene) {
  std::vector<std::string> names;
  for (const Material& material : scene.materials) names.push_back(material.name);
  return names;
}

/// The passes of what the camera's rays meet, filled in pixel by pixel.
class SurfacePasses {
 public:
  SurfacePasses(const Scene& scene, const RenderOptions& options, PassSet set, int threads)
      : scene_(scene),
        set_(set),
        window_(window_of(scene.width, scene.height, options)),
        samples_(std::min(options.spp, most_pass_samples)),
        pixels_(pixels_of(window_)),
        hits_(scene, options, window_, threads, set.has(Pass::denoising)),
        albedo_(set.has(Pass::albedo), passes_, "albedo", "RGB", true, pixels_),
        normal_(set.has(Pass::normal), passes_, "N", "XYZ", true, pixels_),
        position_(set.has(Pass::position), passes_, "P", "XYZ", false, pixels_),
        behind_albedo_(set.has(Pass::denoising), passes_, "denoising_albedo", "RGB", true, pixels_),
        behind_normal_(set.has(Pass::denoising), passes_, "denoising_normal", "XYZ", true, pixels_),
        materials_("CryptoMaterial", material_names(scene), set.has(Pass::material) ? pixels_ : 0),
        objects_("CryptoObject", object_names(scene), set.has(Pass::object) ? pixels_ : 0) {
    if (set.has(Pass::depth)) depth_.resize(pixels_);
  }

  const Window& window() const { return window_; }

  void fill(int x, int y) {
    Sums sums;
    for (std::uint64_t s = 0; s < samples_; ++s) sums.add(scene_, set_, hits_.at(x, y, s));
    store(static_cast<std::size_t>(y - window_.y0) * static_cast<std::size_t>(window_.width()) +
              static_cast<std::size_t>(x - window_.x0),
          sums);
  }

  Passes take() && {
    if (set_.has(Pass::depth)) passes_.channels.push_back({"Z", false, std::move(depth_)});
    if (set_.has(Pass::material)) std::move(materials_).add_to(passes_);
    if (set_.has(Pass::object)) std::move(objects_).add_to(passes_);
    passes_.metadata["castray:pass-samples"] = fmt::format("{}", samples_);
    return std::move(passes_);
  }

 private:
  /// Of a pixel's samples.
  struct Sums {
    Vec3d albedo, normal, behind_albedo, behind_normal, position;
    double depth = 0, found = 0;
    Cryptomatte::Counts materials, objects;

    void add(const Scene& scene, const PassSet& set, const FirstHit& hit) {
      if (!hit.found()) return;
      albedo += Vec3d(hit.appearance.albedo);
      normal += Vec3d(hit.appearance.normal);
      behind_albedo += Vec3d(hit.behind_mirrors.albedo);
      behind_normal += Vec3d(hit.behind_mirrors.normal);
      position += hit.position;
      depth += hit.depth;
      ++found;
      if (set.has(Pass::material)) materials.add(scene.triangle_material[hit.triangle]);
      if (set.has(Pass::object)) objects.add(scene.object_of(hit.triangle));
    }
  };

  void store(std::size_t pixel, const Sums& sums) {
    const auto samples = static_cast<double>(samples_), found = std::max(sums.found, 1.0);
    albedo_.set(pixel, sums.albedo / samples);
    normal_.set(pixel, sums.normal / samples);
    behind_albedo_.set(pixel, sums.behind_albedo / samples);
    behind_normal_.set(pixel, sums.behind_normal / samples);
    position_.set(pixel, sums.position / found);
    if (set_.has(Pass::depth)) depth_[pixel] = static_cast<float>(sums.depth / found);
    if (set_.has(Pass::material)) materials_.set(pixel, sums.materials, samples_);
    if (set_.has(Pass::object)) objects_.set(pixel, sums.objects, samples_);
  }

  const Scene& scene_;
  PassSet set_;
  Window window_;
  std::uint64_t samples_;
  std::size_t pixels_;
  CameraHits hits_;
  Passes passes_;
  VectorPass albedo_, normal_, position_, behind_albedo_, behind_normal_;
  std::vector<float> depth_;
  Cryptomatte materials_, objects_;
};

}  // namespace

std::optional<Passes> render_passes(const Scene& scene, const RenderOptions& options, PassSet set,
                                    const std::function<bool()>& go_on) {
  const int threads = options.threads > 0 ? options.threads : available_threads();
  SurfacePasses passes(scene, options, set, threads);
  const Window& w = passes.window();
  std::atomic<bool> stopped = false;
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (int y = w.y0; y < w.y1; ++y) {
    if (go_on && !stopped && !go_on()) stopped = true;
    for (int x = w.x0; x < w.x1 && !stopped; ++x) passes.fill(x, y);
  }
  if (stopped) return std::nullopt;
  return std::move(passes).take();
}

std::size_t bytes_of_pixel(const PassSet& passes) {
  constexpr std::pair<Pass, std::size_t> channels[] = {{Pass::albedo, 3},
                                                       {Pass::normal, 3},
                                                       {Pass::depth, 1},
                                                       {Pass::position, 3},
                                                       {Pass::denoising, 6},
                                                       {Pass::material, 2 * Cryptomatte::ranks},
                                                       {Pass::object, 2 * Cryptomatte::ranks},
                                                       {Pass::direct, 3},
                                                       {Pass::indirect, 3},
                                                       {Pass::samples, 1}};
  std::size_t count = 0;
  for (const auto& [pass, its_channels] : channels)
    if (passes.has(pass)) count += its_channels;
  return count * sizeof(float);
}

void add_samples(Passes& passes, const Film& film) {
  const Window& w = film.window();
  ImageChannel channel{"samples.Y", false, {}};
  for (int y = w.y0; y < w.y1; ++y)
    for (int x = w.x0; x < w.x1; ++x) channel.values.push_back(static_cast<float>(film.count(x, y)));
  passes.channels.push_back(std::move(channel));
}

void add_light(Passes& passes, PassSet set, const Image& all, const Image& direct) {
  const std::size_t pixels = direct.pixels.size();
  const VectorPass of_direct(set.has(Pass::direct), passes, "direct", "RGB", true, pixels);
  const VectorPass of_indirect(set.has(Pass::indirect), passes, "indirect", "RGB", true, pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    of_direct.set(i, Vec3d(direct.pixels[i]));
    of_indirect.set(i, Vec3d(all.pixels[i]) - Vec3d(direct.pixels[i]));
  }
}

}  // namespace castray
