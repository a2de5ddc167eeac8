#include "cli/scene_bench.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string_view>

#include "bench/measure.h"
#include "castray/error.h"
#include "castray/render.h"
#include "cli/bench_reference.h"
#include "cli/configuration.h"
#include "cli/peer.h"
#include "cli/render_command.h"

namespace castray::cli {

namespace {

/// What --ablation leaves out, one at a time.
constexpr struct {
  const char* name;
  const char* flags;
} ablations[] = {
    {"no shared paths", "--reuse off"},
    {"independent samples", "--sampler independent"},
    {"lights by area", "--lights area"},
    {"no MIS", "--mis off"},
    {"MIS everywhere", "--mis on"},
    {"fixed roulette 0.8", "--rr 0.8"},
    {"one lane (scalar)", "--isa scalar"},
    {"BVH also for few triangles", "--accel bvh"},
    {"every feature (generic)", "--generic"},
    {"means alone", "--reconstruct off"},
    {"one sample at edges too", "--edge-samples 1"},
};

std::filesystem::path default_cache() {
  if (const char* xdg = std::getenv("XDG_CACHE_HOME"); xdg && *xdg)
    return std::filesystem::path(xdg) / "castray";
  const char* home = std::getenv("HOME");
  return std::filesystem::path(home && *home ? home : ".") / ".cache/castray";
}

/// Whether a text of flags has one.
std::function<bool(std::string_view)> has_flag(const std::string& flags) {
  return [words = " " + flags + " "](std::string_view flag) {
    return words.find(" --" + std::string(flag) + " ") != std::string::npos;
  };
}

/// One scene's benchmark: what it needs, made from the flags.
class SceneBench {
 public:
  SceneBench(const BenchFlags& flags, const Scene& scene, const std::string& file, BenchMeter& meter)
      : flags_(flags), file_(file), meter_(meter), scene_(scene) {}

  BenchScene run() {
    BenchScene result;
    result.name = scene_.name;
    result.file = file_;
    const ReferencePair reference = references(result);
    result.reference_image = reference.mean();
    const PixelMask mask = make_mask(result);
    result.reference_noise = reference_noise(reference, mask);
    const BenchPlan plan{flags_.spp, flags_.seconds, flags_.seeds, flags_.equal_time, std::nullopt};
    measure(result, contenders(result), reference, mask, plan,
            [&](const BenchProgress& progress) { meter_.tell(progress); });
    return result;
  }

 private:
  /// Also decides the size: --size, else that of the given references, else the scene's.
  ReferencePair references(BenchScene& result) {
    RenderRequest request = configured_request(scene_, flags_.reference_flags);
    result.width = scene_.width;
    result.height = scene_.height;
    if (!flags_.size.empty()) parse_size(flags_.size, result.width, result.height);
    if (!flags_.reference.empty()) {
      ReferencePair pair = read_references(flags_.reference, scene_.name);
      if (flags_.size.empty()) result.width = pair.a.width, result.height = pair.a.height;
      if (pair.a.width != result.width || pair.a.height != result.height)
        throw InputError(fmt::format("--reference: {}x{} pixels, but --size asks for {}", pair.a.width,
                                     pair.a.height, flags_.size));
      result.reference = flags_.reference;
      return pair;
    }
    request.options.width = result.width;
    request.options.height = result.height;
    request.options.spp = flags_.reference_spp;
    request.options.threads = flags_.threads;
    result.reference = fmt::format("castray {}, 2 x {} spp", flags_.reference_flags, flags_.reference_spp);
    return cached_references(
        scene_, request, flags_.cache.empty() ? default_cache() : std::filesystem::path(flags_.cache),
        [&](int number, const Progress& progress) {
          meter_.tell_part(fmt::format("{} reference {} of 2", scene_.name, number + 1), progress.fraction);
        });
  }

  PixelMask make_mask(BenchScene& result) const {
    if (flags_.mask == "none") return {};
    Scene lights = scene_;
    lights.environment = {};
    lights.environment_image = {};
    RenderOptions options;
    options.integrator = Integrator::reference;
    options.width = result.width;
    options.height = result.height;
    options.spp = 16;
    options.max_depth = 1;
    options.threads = flags_.threads;
    PixelMask mask = away_from_emitters(render(lights, options).film.image());
    const auto counted = static_cast<std::size_t>(std::count(mask.begin(), mask.end(), true));
    if (counted == 0) throw InputError(file_ + ": every pixel sees an emitter; use --mask none");
    result.masked = true;
    result.counted = static_cast<double>(counted) / static_cast<double>(mask.size());
    return mask;
  }

  std::vector<Contender> contenders(const BenchScene& result) const {
    const ConfiguredRender where{scene_, result.width, result.height, flags_.threads};
    std::vector<Contender> all;
    for (const std::string& text : flags_.configurations)
      all.push_back(configuration_contender(where, split_configuration(text), ContenderKind::configuration));
    if (flags_.ablation)
      for (const auto& [name, flags] : ablations)
        all.push_back(configuration_contender(where, {name, all.front().detail + " " + flags},
                                              ContenderKind::ablation));
    for (const std::string& text : flags_.peers)
      all.push_back(peer_contender(Peer::parse(text), file_, result.width, result.height, flags_.threads));
    return all;
  }

  const BenchFlags& flags_;
  const std::string& file_;
  BenchMeter& meter_;
  const Scene& scene_;
};

}  // namespace

void check_bench_scene(const BenchFlags& flags, const Scene& scene) {
  const auto check = [&](const std::string& flag, const std::string& rendering_flags) {
    try {
      RenderRequest request = configured_request(scene, rendering_flags);
      if (!flags.size.empty()) parse_size(flags.size, request.options.width, request.options.height);
      prepare(scene, request);
    } catch (const InputError& error) {
      const InputError told = placed_error(error, scene, has_flag(rendering_flags));
      const bool has_place = std::string_view(told.what()).starts_with(scene.file.string());
      throw has_place ? told : InputError(flag + ": " + told.what());
    }
  };
  if (flags.reference.empty()) check("--reference-flags", flags.reference_flags);
  for (const std::string& text : flags.configurations) {
    const Configuration configuration = split_configuration(text);
    check("--config " + configuration.name, configuration.flags);
  }
}

BenchScene bench_scene(const BenchFlags& flags, const Scene& scene, const std::string& file,
                       BenchMeter& meter) {
  return SceneBench(flags, scene, file, meter).run();
}

}  // namespace castray::cli
