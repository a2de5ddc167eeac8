#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "castray/film.h"
#include "castray/image.h"
#include "castray/render_options.h"
#include "castray/scene.h"

namespace castray {

/// What an EXR file can hold of each pixel besides its radiance; docs/passes.md defines them.
enum class Pass : std::uint8_t {
  albedo,
  normal,
  depth,
  position,
  denoising,  ///< albedo and normal behind mirrors and smooth glass, for denoisers
  material,   ///< as Cryptomatte
  object,     ///< as Cryptomatte
  direct,
  indirect,
  samples,
  variance,  ///< of films with replicates, which write it in any case
};
inline constexpr std::pair<std::string_view, Pass> pass_names[] = {
    {"albedo", Pass::albedo},     {"normal", Pass::normal},       {"depth", Pass::depth},
    {"position", Pass::position}, {"denoising", Pass::denoising}, {"material", Pass::material},
    {"object", Pass::object},     {"direct", Pass::direct},       {"indirect", Pass::indirect},
    {"samples", Pass::samples},   {"variance", Pass::variance}};

class PassSet {
 public:
  void add(Pass pass) { bits_ |= bit(pass); }
  bool has(Pass pass) const { return bits_ & bit(pass); }
  bool empty() const { return bits_ == 0; }

 private:
  static std::uint32_t bit(Pass pass) { return 1u << static_cast<unsigned>(pass); }
  std::uint32_t bits_ = 0;
};

/// Bytes of memory that the passes of a pixel take.
std::size_t bytes_of_pixel(const PassSet& passes);

/// Passes of what the camera's rays meet are means over the first samples of a pixel, at most so many.
inline constexpr std::uint64_t most_pass_samples = 64;

/// Renders those of `passes` that tell what the camera's rays meet, of the options' window: a function of the
/// scene and the options' size, view, seed, sampler, jitter and spp. It does not depend on which samples or
/// which part of the image is rendered. None if `go_on`, asked by several threads, says no.
std::optional<Passes> render_passes(const Scene& scene, const RenderOptions& options, PassSet passes,
                                    const std::function<bool()>& go_on = {});

/// Adds the number of samples of each pixel.
void add_samples(Passes& passes, const Film& film);

/// Adds those of direct and indirect light that are in the set. `direct`: of the same render, its paths ended
/// after two edges.
void add_light(Passes& passes, PassSet set, const Image& all, const Image& direct);

}  // namespace castray
