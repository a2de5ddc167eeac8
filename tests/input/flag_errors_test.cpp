#include <catch2/catch.hpp>

#include <fstream>
#include <string>
#include <vector>

#include "run_castray.h"
#include "temporary_folder.h"

namespace {

/// Words behind "castray", and what must be said about them behind "castray: error: ".
struct Case {
  std::vector<std::string> words;
  std::string message;
};

/// With "s.json" in place of the scene.
Case render(std::vector<std::string> flags, const std::string& message) {
  flags.insert(flags.begin(), {"render", "s.json"});
  return {std::move(flags), message};
}

const std::string whole = "must be a whole number between ";

const std::vector<Case> cases = {
    {{},
     "say what to do: render, serve, compare, accept, bench, info, merge, submit, convert, denoise, "
     "completions; see "
     "castray "
     "--help"},
    {{"rendr"}, "unknown subcommand 'rendr'; did you mean 'render'?"},
    {{"--versio"}, "unknown flag '--versio'; did you mean '--version'?"},
    {{"info", "--jsn", "s.json"}, "unknown flag '--jsn'; see castray info --help"},
    render({"--sp", "1"}, "unknown flag '--sp'; did you mean '--spp'?"),
    render({"extra"}, "unknown argument 'extra'; see castray render --help"),
    {{"nonsense", "--help"}, "unknown subcommand 'nonsense'; see castray --help"},
    {{"help", "rendr"}, "unknown subcommand 'rendr'; did you mean 'render'?"},
    {{"render"}, "SCENE is missing; see castray render --help"},
    {{"compare", "a.png"}, "REFERENCE is missing; see castray compare --help"},
    {{"convert", "a.png"}, "--output FILE is missing; see castray convert --help"},
    {{"completions", "tcsh"}, "WHAT: 'tcsh' is none of its values; known: bash, zsh, fish, man"},
    {{"bench", "s.json", "--mask", "non"}, "--mask: 'non' is none of its values; did you mean 'none'?"},
    {{"bench", "s.json", "--seeds", "1.5"}, "--seeds '1.5': must be a whole number"},
    {{"bench", "s.json", "--seeds", "x"}, "--seeds 'x': must be a number"},
    {{"bench", "s.json", "--spp", "-4"}, "--spp: " + whole + "1 and 4294967295"},
    {{"submit", "slurm", "s.json", "--parts", "0"}, "--parts: must be at least 1"},
    {{"serve", "s.json", "--port", "99999"}, "--port 99999: must be between 0, any that is free, and 65535"},
    {{"compare", "s.json", "s.json", "--html", "./s.json"},
     "./s.json: is one of the files to be compared, or their limits; give another name"},
    {{"info", "."}, ".: is a folder; give a scene file in it, .json, .gltf, .glb, .obj or .ply"},
    {{"compare", "a.png", "a.png", "-t", "0"}, "--threads '0': " + whole + "1 and 4096"},
    render({"--spp"}, "--spp: needs a value, N"),
    render({"-o"}, "--output: needs a value, FILE"),
    render({"--generic=maybe"}, "--generic 'maybe': must be on or off, or left out"),
    render({"-o", "-", "--stats", "-"},
           "more than one output goes to the standard output; give the others names of files"),
    // Numbers
    render({"--spp", "0"}, "--spp '0': " + whole + "1 and 4294967295"),
    render({"--spp", "-1"}, "--spp '-1': " + whole + "1 and 4294967295"),
    render({"--spp", "1e18"}, "--spp '1e18': " + whole + "1 and 4294967295"),
    render({"--spp", "18446744073709551617"}, "--spp '18446744073709551617': " + whole + "1 and 4294967295"),
    render({"--spp", "nan"}, "--spp 'nan': " + whole + "1 and 4294967295"),
    render({"--spp", ""}, "--spp '': " + whole + "1 and 4294967295"),
    render({"--spp", "4 "}, "--spp '4 ': " + whole + "1 and 4294967295"),
    render({"--seed", "-1"}, "--seed '-1': " + whole + "0 and 18446744073709551615"),
    render({"--threads", "0"}, "--threads '0': " + whole + "1 and 4096"),
    render({"--threads", "1e9"}, "--threads '1e9': " + whole + "1 and 4096"),
    render({"--max-depth", "0"}, "--max-depth '0': " + whole + "1 and 1073741823"),
    render({"--rr", "0"}, "--rr 0: must be auto or in (0,1]"),
    render({"--rr", "1.5"}, "--rr 1.5: must be auto or in (0,1]"),
    render({"--rr", "x"}, "--rr 'x': must be a number"),
    render({"--epsilon", "-1"}, "--epsilon -1: must be a number above 0"),
    render({"--epsilon", "nan"}, "--epsilon 'nan': must be a number"),
    render(
        {"--epsilon", "0.01", "--integrator", "wavefront"},
        "--epsilon 0.01: only the reference integrator has an absolute epsilon, not --integrator wavefront; "
        "leave one out"),
    render(
        {"--epsilon", "0.01", "--isa", "avx2"},
        "--isa avx2: the reference integrator, which --epsilon 0.01 asks for, has no vector kernels; leave "
        "one out"),
    render({"--epsilon", "0.01", "--lights", "tree"},
           "--lights: the reference integrator, which --epsilon 0.01 asks for, samples lights by area only; "
           "leave one out"),
    render(
        {"--epsilon", "0.01", "--reuse", "8x8:16"},
        "--reuse: the reference integrator, which --epsilon 0.01 asks for, shares no paths; leave one out"),
    render({"--clamp-indirect", "0"}, "--clamp-indirect 0: must be a number above 0"),
    render({"--clamp-indirect", "inf"}, "--clamp-indirect 'inf': must be a number"),
    render({"--time-limit", "-1"}, "--time-limit -1: must be a number above 0"),
    render({"--target-error", "0"}, "--target-error 0: must be a number above 0"),
    render({"--target-error", "1e-3", "--samples", "0:4"},
           "--target-error: cannot go with --samples; leave one out"),
    render({"--target-error", "1e-3", "--checkpoint", "x.film"},
           "--target-error: cannot go with --checkpoint; leave one out"),
    render({"--target-error", "1e-3", "--replicates", "4"},
           "--replicates: cannot go with --checkpoint, --preview-every, --time-limit or --target-error; "
           "leave one out"),
    render({"--exposure", "bright"}, "--exposure 'bright': must be a number"),
    // Sizes and windows
    render({"--size", "640"}, "--size '640': must be WIDTHxHEIGHT, as in 640x480"),
    render({"--size", "10x10x10"}, "--size '10x10x10': must be WIDTHxHEIGHT, as in 640x480"),
    render({"--size", "0x5"}, "--size '0': " + whole + "1 and 65536"),
    render({"--size", "4294967297x1"}, "--size '4294967297': " + whole + "1 and 65536"),
    render({"--size", "65536x65536"},
           "--size 65536x65536: each side must be between 1 and 65536, and 268435456 pixels in all at most"),
    render({"--crop", "a,b"}, "--crop 'a,b': must be X0,Y0,X1,Y1 in pixels"),
    render({"--crop", "5,5,1,1"},
           "--crop 5,5,1,1: must be X0,Y0,X1,Y1 with 0 <= X0 < X1 <= 8 and 0 <= Y0 < Y1 <= 8"),
    render({"--crop", "0,0,9,9"},
           "--crop 0,0,9,9: must be X0,Y0,X1,Y1 with 0 <= X0 < X1 <= 8 and 0 <= Y0 < Y1 <= 8"),
    render({"--samples", "5"}, "--samples '5': must be FIRST:COUNT, as in 64:64"),
    render({"--samples", "0:0"}, "--samples '0': " + whole + "1 and 4294967295"),
    render({"--reuse", "8x8"}, "--reuse '8x8': must be auto, off or WIDTHxHEIGHT:SUFFIXES, as in 8x8:32"),
    // Choices
    render({"--integrator", "fast"},
           "--integrator: 'fast' is none of its values; known: wavefront, reference"),
    render({"--precision", "half"}, "--precision: 'half' is none of its values; known: float, double"),
    render({"--lights", "treee"}, "--lights: 'treee' is none of its values; did you mean 'tree'?"),
    render({"--tone", "gamma:0"}, "unknown tone curve 'gamma:0'; use srgb, linear, or gamma:G with G > 0"),
    // Views
    render({"--fov", "0"}, "the camera's fov must be at least 1e-05 and less than 180 degrees, not 0"),
    render({"--fov", "180"}, "the camera's fov must be at least 1e-05 and less than 180 degrees, not 180"),
    render({"--look-from", "nan,0,0"}, "--look-from 'nan': must be a number"),
    render({"--look-from", "0,0"}, "--look-from '0,0': must be X,Y,Z"),
    render({"--look-from", "0,0,1", "--look-at", "0,0,1"},
           "the camera's look_at must differ from its position"),
    render({"--look-from", "0,0,1", "--look-at", "0,0,0", "--up", "0,0,1"},
           "the camera's up must not be parallel to its view direction"),
    render({"--environment", "sky.exr"}, "sky.exr: does not exist"),
    render({"--environment", "sky"}, "--environment 'sky': must be R,G,B, an image file or off"),
    render({"--environment", "1,-1,1"},
           "--environment '1,-1,1': must be 0, or at least 1e-30 and at most 1e+30 in each of R,G,B"),
    // Outputs
    render({"-o", "x"}, "x: has no suffix; written are .ppm .png .pfm .hdr .exr .film"),
    render({"-o", "x.jpg"},
           "x.jpg: images of '.jpg' are read only; written are .ppm .png .pfm .hdr .exr .film"),
    render({"-o", "x.tif"}, "x.tif: unknown image format '.tif'; written are .ppm .png .pfm .hdr .exr .film"),
    render({"-o", "gone/x.png"}, "gone/x.png: the folder gone does not exist; create it first"),
    render({"-o", "."}, ".: is a folder; give a file name"),
    render({"-o", ""}, "an output file's name is empty; give a path"),
    render({"--stats", "gone/s.json"}, "gone/s.json: the folder gone does not exist; create it first"),
    render({"--checkpoint", "x.png"}, "x.png: a checkpoint's name must end in .film"),
    render({"--resume"}, "--resume: needs --checkpoint FILE to resume from"),
};

}  // namespace

TEST_CASE("a fault in the flags gives one line, exit code 2, and no file") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v -1 -1 0\nv 0 1 0\nv 1 -1 0\nf 1 2 3\n";
  std::ofstream(folder / "s.json")
      << R"({ "image": { "width": 8, "height": 8 }, "environment": { "radiance": [1, 1, 1] },
      "meshes": [ { "obj": "t.obj" } ] })";
  for (const Case& faulty : cases) {
    std::string shown = "castray";
    for (const std::string& word : faulty.words) shown += " " + word;
    INFO(shown);
    const RunResult outcome = run_castray(faulty.words, folder.path());
    CHECK(outcome.but_for_reading() == "castray: error: " + faulty.message + "\n");
    CHECK(outcome.exit_code == 2);
    CHECK(outcome.out == "");
  }
  CHECK(folder.names() == std::vector<std::string>{"s.json", "t.obj"});
}

TEST_CASE("a scene's own flags are refused with their place") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << "v -1 -1 0\nv 0 1 0\nv 1 -1 0\nf 1 2 3\n";
  const auto message = [&](const std::string& render) {
    std::ofstream(folder / "s.json") << "{\n  \"render\": { " << render
                                     << " },\n  \"meshes\": [ { \"obj\": \"t.obj\" } ]\n}\n";
    const RunResult outcome = run_castray({"render", "s.json"}, folder.path());
    CHECK(outcome.exit_code == 2);
    return outcome.but_for_reading();
  };
  CHECK(message(R"("spq": 1)") ==
        "castray: error: s.json:2:15: unknown key 'spq' in \"render\"; did you mean 'spp'?\n");
  CHECK(message(R"("seed": 1, "spp": 0)") ==
        "castray: error: s.json:2:26: --spp '0': must be a whole number between 1 and 4294967295\n");
}
