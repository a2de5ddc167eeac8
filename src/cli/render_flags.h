#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "castray/image.h"
#include "castray/passes.h"
#include "castray/render.h"
#include "castray/scene.h"
#include "cli/part.h"
#include "plan/fault.h"

namespace castray::cli {

enum class ProgressMode : unsigned char { automatic, bar, lines, json, off };

/// A view given by flags; what is missing is the scene's.
struct CameraFlags {
  std::optional<std::string> name;  ///< or number, of one of the scene's
  std::optional<Vec3d> position, look_at, up;
  std::optional<double> fov;
};

/// What the flags change of the scene that its files tell.
struct SceneFlags {
  CameraFlags camera;
  std::optional<Vec3d> environment;                        ///< radiance from everywhere
  std::optional<std::filesystem::path> environment_image;  ///< instead, in latitude and longitude
  bool two_sided_lights = false;
  bool strict = false;  ///< warnings of the scene's files are errors
};

/// Everything that the flags of `castray render` say.
struct RenderRequest {
  RenderOptions options;
  SceneFlags scene;
  Fault fault = Fault::none;
  Display display;
  PassSet passes;              ///< that .exr outputs hold besides the image
  bool metadata_time = false;  ///< images say how long they took
  std::vector<std::filesystem::path> outputs;
  std::optional<std::filesystem::path> checkpoint, stats;
  double checkpoint_seconds = 60;
  std::optional<double> preview_seconds;  ///< outputs are rewritten this often
  bool preview_in_terminal = false;
  std::optional<std::uint64_t> memory_limit;  ///< bytes
  std::optional<std::string> tev;             ///< address of a viewer
  bool until_time_limit = false;              ///< no number of samples ends the render
  std::optional<Part> part;                   ///< only these of the samples
  std::uint64_t replicates = 0;               ///< 0: one film that does not tell its noise
  bool resume = false, quiet = false, verbose = false;
  ProgressMode progress = ProgressMode::automatic;
};

/// One flag of `castray render`: its line in the help and what it does to a request.
struct RenderFlag {
  const char* name;     ///< without dashes
  const char* metavar;  ///< null for a switch, which is set with the value "on"
  const char* help;
  const char* group;
  void (*set)(RenderRequest& request, const std::string& flag, const std::string& value);
  bool in_scene = true;  ///< may stand in a scene file's "render" section
  char letter = 0;       ///< its short form: 't' of -t
};

std::span<const RenderFlag> render_flags();

/// Per pixel.
inline constexpr std::uint64_t most_samples = std::numeric_limits<std::uint32_t>::max();

/// Sets what a scene's "render" section says. Throws InputError with its place.
void apply_defaults(RenderRequest& request, const Scene& scene);

/// The scene made ready for the request.
PreparedScene prepare(const Scene& scene, const RenderRequest& request);

/// Gives the scene the size, view, environment and sides of lights of the flags. Throws InputError where its
/// files have warnings and --strict is given.
void apply_flags(const RenderRequest& request, Scene& scene);

}  // namespace castray::cli
