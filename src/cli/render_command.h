#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "castray/error.h"
#include "cli/arguments.h"
#include "cli/common_flags.h"
#include "cli/given_flag.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// What a command line says of a render, as text: values are read after the scene's own defaults.
struct RenderCommand {
  std::string scene;
  std::vector<std::string> outputs;
  std::vector<GivenFlag> given;
};

/// Declares one flag; what the command line says of it is added to `given`, which outlives the parsing.
void declare_flag(Arguments& arguments, const RenderFlag& flag, std::vector<GivenFlag>& given);

/// Declares SCENE, all flags of `castray render`, and -o.
void declare_flags(Arguments& arguments, RenderCommand& command);

/// Reads the scene, and says so if that takes long. Its own defaults are not known before.
Scene load_told(const std::string& file, const std::vector<GivenFlag>& given, const CommonFlags& common);

/// Throws InputError where a value cannot be, also one of the scene's own defaults.
RenderRequest request_of(const RenderCommand& command, const CommonFlags& common, const Scene& scene);

/// Whether one of the flags has this name.
bool is_given(std::string_view flag, const std::vector<GivenFlag>& given);

/// The same error, at its place in the scene file where it is of one of the scene's own defaults, which no
/// given flag replaces.
InputError placed_error(const InputError& error, const Scene& scene,
                        const std::function<bool(std::string_view)>& is_given);

/// Finds what could spoil the result, or the scene's file, before the work starts. Throws InputError.
void check(const RenderRequest& request, const std::filesystem::path& scene);

}  // namespace castray::cli
