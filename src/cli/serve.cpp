#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <thread>

#include "castray/error.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/page_server.h"
#include "cli/phase.h"
#include "cli/render_command.h"

namespace castray::cli {

namespace {

/// Flags of `castray render` that have no meaning for a page that shows one image as long as it is looked at.
constexpr std::string_view not_served[] = {"spp",          "samples",       "part",       "replicates",
                                           "crop",         "integrator",    "precision",  "epsilon",
                                           "fault",        "tone",          "bits",       "stats",
                                           "metadata",     "time-limit",    "checkpoint", "checkpoint-every",
                                           "resume",       "preview-every", "preview",    "tev",
                                           "memory-limit", "target-error"};

struct Serve {
  std::string file;
  std::vector<GivenFlag> given;
  int port = 0;

  RenderRequest request(const Scene& scene) const {
    RenderRequest request;
    apply_defaults(request, scene);
    for (const GivenFlag& one : given) one.flag->set(request, one.flag->name, one.value);
    RenderOptions& options = request.options;
    options.spp = most_samples;
    options.time_limit.reset();
    options.target_error.reset();
    if (options.integrator == Integrator::reference || options.epsilon)
      throw InputError(file +
                       ": castray serve shows the wavefront integrator only; take \"integrator\" and "
                       "\"epsilon\" out of the scene's \"render\"");
    return request;
  }

  /// Those that render the image of a view again.
  std::string image_flags() const {
    static constexpr std::string_view others[] = {"look-from", "look-at", "up",  "fov",
                                                  "exposure",  "threads", "isa", "progress"};
    std::string text;
    for (const GivenFlag& one : given)
      if (std::find(std::begin(others), std::end(others), one.flag->name) == std::end(others))
        text += one.text();
    return text;
  }

  int run(const CommonFlags& common) const {
    constexpr int most_port = 65535;
    if (port < 0 || port > most_port)
      throw InputError(
          fmt::format("--port {}: must be between 0, any that is free, and {}", port, most_port));
    Scene scene = load_told(file, given, common);
    try {
      return show(scene, common);
    } catch (const InputError& error) {
      throw placed_error(error, scene, [&](std::string_view flag) { return is_given(flag, given); });
    }
  }

  int show(Scene& scene, const CommonFlags& common) const {
    const RenderRequest asked = request(scene);
    apply_flags(asked, scene);
    catch_interrupts();
    std::unique_ptr<LiveRender> render;
    {
      const Phase phase(common.quiet ? ProgressMode::off : asked.progress,
                        fmt::format("preparing {} triangles", scene.triangles.size()));
      render = std::make_unique<LiveRender>(scene, asked.options);
    }
    const PageServer server({scene, scene.name, image_flags(), asked.display.exposure}, *render, port);
    fmt::print("{}\n", server.address());
    std::fflush(stdout);
    if (!common.quiet) fmt::print(stderr, "castray: the page above shows {}; Ctrl-C ends it\n", file);
    while (!interrupted() && render->error().empty())
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    if (const std::string error = render->error(); !error.empty()) throw InputError(error);
    return 0;
  }
};

}  // namespace

Run add_serve(Arguments& arguments, const CommonFlags& common) {
  const auto serve = std::make_shared<Serve>();
  arguments.add_positional("SCENE", serve->file, "scene .json, .gltf, .glb, .obj or .ply").required();
  arguments.add("--port", serve->port, "N", "of 127.0.0.1 [any that is free]");
  for (const RenderFlag& flag : render_flags())
    if (std::find(std::begin(not_served), std::end(not_served), flag.name) == std::end(not_served))
      declare_flag(arguments, flag, serve->given);
  arguments.footer(
      "Prints the page's address, which works on this machine only and has a random token in it. Ctrl-C ends "
      "it, with exit code 0.");
  return [serve, &common] { return serve->run(common); };
}

}  // namespace castray::cli
