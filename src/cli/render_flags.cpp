#include "cli/render_flags.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include "castray/error.h"
#include "castray/image.h"
#include "castray/scene.h"
#include "cli/display_flags.h"
#include "cli/memory_limit.h"
#include "cli/render_passes.h"
#include "cli/values.h"
#include "core/files.h"
#include "core/nearest.h"
#include "core/range.h"
#include "core/text.h"
#include "plan/option_names.h"
#include "render/prepared_scene.h"

namespace castray::cli {

namespace {

using Text = const std::string&;
using Request = RenderRequest&;

constexpr std::uint64_t most_whole = std::numeric_limits<std::uint64_t>::max();

constexpr std::string_view switch_values[] = {"on", "off"};

bool parse_on_off(Text flag, Text text) {
  return parse_choice<bool>(flag, text, {{switch_values[0], true}, {switch_values[1], false}});
}

std::optional<double> number_or_auto(Text flag, Text text) {
  if (text == "auto") return std::nullopt;
  return parse_number(flag, text);
}

[[noreturn]] void refuse(Text flag, Text text, const std::string& expected) {
  throw InputError("--" + flag + " '" + printable(text) + "': must be " + expected);
}

int parse_side(Text flag, Text text) { return static_cast<int>(parse_whole(flag, text, 1, max_image_side)); }

void set_size(Request r, Text flag, Text text) {
  const auto sides = split(text, 'x');
  if (sides.size() != 2) refuse(flag, text, "WIDTHxHEIGHT, as in 640x480");
  r.options.width = parse_side(flag, sides[0]);
  r.options.height = parse_side(flag, sides[1]);
}

void set_crop(Request r, Text flag, Text text) {
  const auto edges = split(text, ',');
  if (edges.size() != 4) refuse(flag, text, "X0,Y0,X1,Y1 in pixels");
  const auto edge = [&](std::size_t i) {
    return static_cast<int>(parse_whole(flag, edges[i], 0, max_image_side));
  };
  r.options.crop = Window{0, 0, edge(0), edge(1), edge(2), edge(3)};
}

void set_samples(Request r, Text flag, Text text) {
  const auto parts = split(text, ':');
  if (parts.size() != 2) refuse(flag, text, "FIRST:COUNT, as in 64:64");
  r.options.samples = SampleRange{parse_whole(flag, parts[0], 0, most_whole - most_samples),
                                  parse_whole(flag, parts[1], 1, most_samples)};
}

void set_reuse(Request r, Text flag, Text text) {
  r.options.reuse = {.automatic = text == "auto"};
  if (text == "auto" || text == "off") return;
  const auto parts = split(text, ':');
  const auto sides = split(parts[0], 'x');
  if (parts.size() != 2 || sides.size() != 2)
    refuse(flag, text, "auto, off or WIDTHxHEIGHT:SUFFIXES, as in 8x8:32");
  constexpr std::uint64_t longest = 64;
  const auto number = [&](Text part, std::uint64_t most) {
    return static_cast<int>(parse_whole(flag, part, 1, most));
  };
  r.options.reuse.width = number(sides[0], longest);
  r.options.reuse.height = number(sides[1], longest);
  r.options.reuse.suffixes = number(parts[1], longest * longest);
}

void set_environment(Request r, Text flag, Text text) {
  r.scene.environment = Vec3d{};
  r.scene.environment_image.reset();
  if (text == "off") return;
  if (is_image_format(text)) {
    r.scene.environment_image = text;
    return;
  }
  if (split(text, ',').size() != 3) refuse(flag, text, "R,G,B, an image file or off");
  r.scene.environment = parse_vector(flag, text);
  for (int i = 0; i < 3; ++i)
    if (!radiance_range.contains((*r.scene.environment)[i]))
      refuse(flag, text, radiance_range.text() + " in each of R,G,B");
}

constexpr const char* sampling = "Samples";
constexpr const char* image = "Image";
constexpr const char* estimator = "Estimator";
constexpr const char* machine = "Machine";
constexpr const char* stopping = "Stopping and resuming";
constexpr const char* output = "Output";
constexpr const char* view = "View (else the scene's; a mesh alone gets an automatic one)";
constexpr const char* lighting = "Scene";

const RenderFlag flags[] = {
    {"spp", "N", "samples per pixel [scene's, else 64]", sampling,
     [](Request r, Text f, Text t) { r.options.spp = parse_whole(f, t, 1, most_samples); }},
    {"samples", "FIRST:COUNT", "render these sample indices only, for 'castray merge'", sampling, set_samples,
     false},
    {"part", "I/N|auto|auto/N",
     "part I of N of the samples, from 0, for 'castray merge'; auto: as a Slurm array, Kubernetes, AWS Batch "
     "or "
     "MPI says; {part} in names of files is its number",
     sampling, [](Request r, Text f, Text t) { r.part = parse_part(f, t); }, false},
    {"seed", "N", "other random numbers for each [0]", sampling,
     [](Request r, Text f, Text t) { r.options.seed = parse_whole(f, t, 0, most_whole); }},
    {"replicates", "R",
     "share the samples out to R independent replicates, for 'castray compare --ztest'; not with "
     "--checkpoint, --preview-every, --time-limit or --target-error",
     sampling, [](Request r, Text f, Text t) { r.replicates = parse_whole(f, t, 1, 4096); }, false},
    {"sampler", "sobol|independent", "Sobol's sequence or independent random numbers [sobol]", sampling,
     [](Request r, Text f, Text t) { r.options.sampler = parse_choice(f, t, sampler_names); }},
    {"jitter", "on|off", "off: every sample through the pixel's centre [on]", sampling,
     [](Request r, Text f, Text t) { r.options.jitter = parse_on_off(f, t); }},

    {"size", "WxH", "image size in pixels [scene's]", image, set_size},
    {"crop", "X0,Y0,X1,Y1", "the window x0 <= x < x1, y0 <= y < y1 only, as an image of its own size", image,
     set_crop, false},
    {"camera", "NAME|INDEX", "which of the scene's cameras, by name or counted from 0 [the first]", view,
     [](Request r, Text, Text t) { r.scene.camera.name = t; }, false},
    {"look-from", "X,Y,Z", "where the camera is", view,
     [](Request r, Text f, Text t) { r.scene.camera.position = parse_vector(f, t); }, false},
    {"look-at", "X,Y,Z", "where it looks [the scene's middle]", view,
     [](Request r, Text f, Text t) { r.scene.camera.look_at = parse_vector(f, t); }, false},
    {"up", "X,Y,Z", "the direction that is up in the image [0,1,0]", view,
     [](Request r, Text f, Text t) { r.scene.camera.up = parse_vector(f, t); }, false},
    {"fov", "DEGREES", "vertical field of view [40]", view,
     [](Request r, Text f, Text t) { r.scene.camera.fov = parse_number(f, t); }, false},
    {"environment", "R,G,B|FILE|off",
     "radiance from all around, or an image of it [the scene's; 1,1,1 where nothing emits]", lighting,
     set_environment, false},
    {"two-sided-lights", nullptr, "all lights shine on both sides", lighting,
     [](Request r, Text f, Text t) { r.scene.two_sided_lights = parse_on_off(f, t); }, false},
    {"strict", nullptr, "what is missing or odd in the scene's files is an error", lighting,
     [](Request r, Text f, Text t) { r.scene.strict = parse_on_off(f, t); }, false},

    {"integrator", "wavefront|reference",
     "the fast one, or the recursive castRay [wavefront; with --epsilon reference]", estimator,
     [](Request r, Text f, Text t) {
       r.options.integrator = parse_choice<Integrator>(
           f, t, {{"wavefront", Integrator::wavefront}, {"reference", Integrator::reference}});
     }},
    {"precision", "float|double", "of the reference [float]", estimator,
     [](Request r, Text f, Text t) { r.options.precision = parse_choice(f, t, precision_names); }},
    {"rr", "auto|P", "Russian roulette: by throughput, or a fixed survival probability in (0,1] [auto]",
     estimator, [](Request r, Text f, Text t) { r.options.rr = number_or_auto(f, t); }},
    {"max-depth", "N|none", "most edges of a path: 1 emitters only, 2 direct light [none]", estimator,
     [](Request r, Text f, Text t) {
       r.options.max_depth =
           t == "none" ? 0 : static_cast<int>(parse_whole(f, t, 1, std::numeric_limits<int>::max() / 2));
     }},
    {"epsilon", "auto|X", "rays start by per-hit error bounds, or by the classic absolute epsilon [auto]",
     estimator, [](Request r, Text f, Text t) { r.options.epsilon = number_or_auto(f, t); }},
    {"lights", "auto|area|solid-angle|tree", "how light points are chosen [auto]", estimator,
     [](Request r, Text f, Text t) { r.options.lights = parse_choice(f, t, light_sampling_names); }},
    {"mis", "on|off|auto", "multiple importance sampling of lights and BSDFs [auto]", estimator,
     [](Request r, Text f, Text t) { r.options.mis = parse_choice(f, t, switch_names); }},
    {"caustics", "auto|on|off",
     "light by mirrors and glass: from the lights' side, or off, by chance from the camera's [auto: where it "
     "can]",
     estimator, [](Request r, Text f, Text t) { r.options.caustics = parse_choice(f, t, switch_names); }},
    {"reuse", "auto|off|WxH:N", "share N path suffixes in tiles of WxH pixels [auto]", estimator, set_reuse},
    {"reconstruct", "auto|on|off",
     "the image from means and differences of pixels that share paths, unbiased [auto: where a pilot "
     "finds that it pays]",
     estimator, [](Request r, Text f, Text t) { r.options.reconstruct = parse_choice(f, t, switch_names); }},
    {"edge-samples", "auto|N",
     "where the image is reconstructed, samples of the places that see edges for each sample of others "
     "[auto: 3, with mirrors or glass 1]",
     estimator,
     [](Request r, Text f, Text t) {
       r.options.edge_samples =
           t == "auto" ? std::nullopt
                       : std::optional(static_cast<int>(parse_whole(f, t, 1, most_edge_samples)));
     }},
    {"clamp-indirect", "X|off",
     "scale a sample's indirect light down to X: fewer bright dots, but biased [off]", estimator,
     [](Request r, Text f, Text t) {
       r.options.clamp_indirect = t == "off" ? std::nullopt : std::optional(parse_number(f, t));
     }},
    {"fault", "NAME", "a classic fault (docs/classic-faults.md) to be seen on the reference", estimator,
     [](Request r, Text f, Text t) { r.fault = parse_choice(f, t, fault_names); }},

    {"threads", "N", "at most so many [the processors allowed to this process, cgroup limits read]", machine,
     [](Request r, Text f, Text t) { r.options.threads = static_cast<int>(parse_whole(f, t, 1, 4096)); },
     true, 't'},
    {"isa", "auto|scalar|...", "instruction set of the kernels [auto]", machine,
     [](Request r, Text, Text t) { r.options.isa = t; }},
    {"accel", "auto|list|bvh", "how triangles are found [auto]", machine,
     [](Request r, Text f, Text t) {
       r.options.accel = parse_choice<AccelKind>(
           f, t, {{"auto", AccelKind::automatic}, {"list", AccelKind::list}, {"bvh", AccelKind::bvh}});
     }},
    {"build", "auto|fast|best", "quality of the tree [auto]", machine,
     [](Request r, Text f, Text t) {
       r.options.build = parse_choice<BuildQuality>(
           f, t,
           {{"auto", BuildQuality::automatic}, {"fast", BuildQuality::fast}, {"best", BuildQuality::best}});
     }},
    {"memory-limit", "SIZE",
     "end with an error rather than render with more, as in 4G; -v tells what is needed", machine,
     [](Request r, Text f, Text t) { r.memory_limit = parse_bytes(f, t); }, false},
    {"generic", nullptr, "run the kernel that can do everything, whatever the scene needs", machine,
     [](Request r, Text f, Text t) { r.options.generic = parse_on_off(f, t); }},

    {"time-limit", "SECONDS", "the best image in this time; with --spp or --samples: at most so many",
     stopping, [](Request r, Text f, Text t) { r.options.time_limit = parse_number(f, t); }},
    {"target-error", "E",
     "render until the relMSE is about E, more samples where there is more noise; --spp: at most", stopping,
     [](Request r, Text f, Text t) { r.options.target_error = parse_number(f, t); }},
    {"checkpoint", "FILE", "keep the sums so far in this .film, and those before in FILE.previous.film",
     stopping, [](Request r, Text, Text t) { r.checkpoint = t; }, false},
    {"checkpoint-every", "SECONDS", "[60]", stopping,
     [](Request r, Text f, Text t) {
       r.checkpoint_seconds = parse_number(f, t);
       if (!(r.checkpoint_seconds >= 0)) refuse(f, t, "a number of seconds");
     }},
    {"resume", nullptr, "go on from the checkpoint file, if it is there", stopping,
     [](Request r, Text f, Text t) { r.resume = parse_on_off(f, t); }, false},
    {"preview-every", "SECONDS", "write the outputs so far this often; SIGUSR1 does it once", stopping,
     [](Request r, Text f, Text t) {
       r.preview_seconds = parse_number(f, t);
       if (!(*r.preview_seconds >= 0)) refuse(f, t, "a number of seconds");
     },
     false},
    {"preview", "terminal|off", "terminal: the image so far, in half blocks of 24-bit colour [off]", stopping,
     [](Request r, Text f, Text t) {
       r.preview_in_terminal = parse_choice<bool>(f, t, {{"terminal", true}, {"off", false}});
     },
     false},
    {"tev", "HOST:PORT", "show the image so far in the viewer tev, which is there: 127.0.0.1:14158", stopping,
     [](Request r, Text, Text t) { r.tev = t; }, false},

    {"exposure", "STOPS", "of .ppm and .png [0]", output,
     [](Request r, Text f, Text t) { r.display.exposure = parse_number(f, t); }},
    {"tone", "srgb|linear|gamma:G", "curve of .ppm and .png; gamma:G is value^G [srgb]", output,
     [](Request r, Text, Text t) { r.display.tone = parse_tone_curve(t); }},
    {"bits", "auto|16", bits_help, output,
     [](Request r, Text f, Text t) { r.display.bits16 = parse_bits(f, t); }, false},
    {"passes", "LIST|all",
     "what .exr files hold besides the image: albedo,normal,depth,position,denoising,material,object,direct,"
     "indirect,samples,variance (docs/passes.md)",
     output, [](Request r, Text f, Text t) { r.passes = parse_passes(f, t); }, false},
    {"metadata", "plain|time", "time: PNG and EXR files tell how long they took, so no two are equal [plain]",
     output,
     [](Request r, Text f, Text t) {
       r.metadata_time = parse_choice<bool>(f, t, {{"plain", false}, {"time", true}});
     },
     false},
    {"progress", "auto|bar|lines|json|off", "on stderr [auto: a bar on a terminal, else lines]", output,
     [](Request r, Text f, Text t) {
       r.progress = parse_choice<ProgressMode>(f, t,
                                               {{"auto", ProgressMode::automatic},
                                                {"bar", ProgressMode::bar},
                                                {"lines", ProgressMode::lines},
                                                {"json", ProgressMode::json},
                                                {"off", ProgressMode::off}});
     }},
    {"stats", "FILE", "write times and counts as JSON", output, [](Request r, Text, Text t) { r.stats = t; },
     false},
};

}  // namespace

std::span<const RenderFlag> render_flags() { return flags; }

void apply_defaults(RenderRequest& request, const Scene& scene) {
  for (const RenderDefault& given : scene.render_defaults) {
    const RenderFlag* found = nullptr;
    std::vector<std::string_view> names;
    for (const RenderFlag& flag : flags) {
      if (!flag.in_scene) continue;
      names.push_back(flag.name);
      if (given.name == flag.name) found = &flag;
    }
    if (!found)
      throw InputError(given.place, "unknown key '" + printable(given.name) + "' in \"render\"" +
                                        suggestion(given.name, names));
    try {
      found->set(request, given.name, given.value);
    } catch (const InputError& error) {
      throw InputError(given.place, error.what());
    }
  }
}

PreparedScene prepare(const Scene& scene, const RenderRequest& request) {
  return PreparedAccess::prepare(scene, request.options, request.fault);
}

namespace {

/// Makes the camera of that name, or else of that number, the scene's.
void choose_camera(const std::string& wanted, Scene& scene) {
  const auto named = std::ranges::find(scene.cameras, wanted, &SceneCamera::name);
  std::size_t i = static_cast<std::size_t>(named - scene.cameras.begin());
  if (named == scene.cameras.end() && !wanted.empty() &&
      std::ranges::all_of(wanted, [](unsigned char c) { return std::isdigit(c); }))
    std::from_chars(wanted.data(), wanted.data() + wanted.size(), i);
  if (i >= scene.cameras.size()) {
    std::vector<std::string> names;
    for (const SceneCamera& camera : scene.cameras) names.push_back(printable(camera.name));
    throw InputError(
        fmt::format("--camera {}: {} has no such camera; {}", printable(wanted), scene.file.string(),
                    names.empty() ? "it has none" : fmt::format("it has {}", fmt::join(names, ", "))));
  }
  const SceneCamera& chosen = scene.cameras[i];
  scene.camera = chosen.camera;
  if (chosen.width > 0) scene.width = chosen.width, scene.height = chosen.height;
}

/// The scene's camera, or the one that the flags describe. The image's size is final.
Camera camera_of(const CameraFlags& given, const Scene& scene) {
  if (!given.position && !given.look_at && !given.up && !given.fov)
    return scene.has_camera ? scene.camera : automatic_camera(scene);
  const Camera& own = scene.camera;
  const Vec3d position = given.position ? scene.to_scene(*given.position) : own.position;
  const Vec3d look_at = given.look_at    ? scene.to_scene(*given.look_at)
                        : given.position ? Vec3d()  // the middle of the scene
                                         : own.position + own.forward;
  const double own_fov = std::atan(own.tan_half_fov) * 360 / std::numbers::pi;
  return make_camera(position, look_at, given.up.value_or(given.position ? Vec3d(0, 1, 0) : own.up),
                     given.fov.value_or(own_fov), own);
}

}  // namespace

void apply_flags(const RenderRequest& request, Scene& scene) {
  const SceneFlags& flags = request.scene;
  if (flags.strict && !scene.warnings.empty())
    throw InputError(scene.warnings.front().place, scene.warnings.front().message);
  if (flags.camera.name) choose_camera(*flags.camera.name, scene);
  if (request.options.width > 0) scene.width = request.options.width, scene.height = request.options.height;
  scene.camera = camera_of(flags.camera, scene);
  if (flags.environment) {
    scene.environment = *flags.environment;
    scene.environment_image = {};
    if (flags.environment_image) replace_environment(*flags.environment_image, scene);
    scene.default_environment = false;
  }
  if (flags.two_sided_lights)
    for (Material& material : scene.materials)
      material.two_sided_emission |= material.emits() && !material.has_back() && !material.emits_backwards;
}

}  // namespace castray::cli
