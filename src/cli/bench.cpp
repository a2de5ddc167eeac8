#include <fmt/core.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "bench/report.h"
#include "castray/error.h"
#include "castray/image.h"
#include "cli/bench_meter.h"
#include "cli/commands.h"
#include "cli/configuration.h"
#include "cli/display_flags.h"
#include "cli/peer.h"
#include "cli/process.h"
#include "cli/scene_bench.h"
#include "cli/shell_word.h"
#include "core/files.h"
#include "core/text.h"
#include "core/threads.h"

namespace castray::cli {

namespace {

std::string cpu_name() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown processor";
}

/// The words that this process was started with.
std::string command_line() {
  std::string words = read_file("/proc/self/cmdline"), line;
  for (std::size_t at = 0; at < words.size(); at = words.find('\0', at) + 1) {
    const std::string word = words.c_str() + at;
    const bool plain = word.find_first_of(" '\"{}$&|;<>()*?") == std::string::npos;
    line += (line.empty() ? "" : " ") + (plain ? word : shell_word(word));
  }
  return line;
}

/// Tables and pictures tell contenders apart by name.
void check_names(const BenchFlags& flags) {
  std::set<std::string> names;
  const auto check = [&](const char* flag, const std::string& name) {
    if (!names.insert(name).second)
      throw InputError(fmt::format("{} '{}': another contender has that name; give it one of its own", flag,
                                   printable(name)));
  };
  for (const std::string& text : flags.configurations) check("--config", split_configuration(text).name);
  for (const std::string& text : flags.peers) check("--peer", Peer::parse(text).name);
}

void check_flags(const BenchFlags& flags) {
  const auto check_count = [](const char* flag, std::uint64_t count) {
    constexpr std::uint64_t most = std::numeric_limits<std::uint32_t>::max();  // below 0, CLI11 wraps round
    if (count < 1 || count > most)
      throw InputError(fmt::format("{}: must be a whole number between 1 and {}", flag, most));
  };
  check_count("--seeds", flags.seeds);
  check_count("--reference-spp", flags.reference_spp);
  for (const std::uint64_t spp : flags.spp) check_count("--spp", spp);
  for (const double seconds : flags.seconds)
    if (!(seconds > 0)) throw InputError("--seconds: each budget must be above 0");
  check_names(flags);
  if (flags.equal_time && !(*flags.equal_time > 0)) throw InputError("--equal-time: must be above 0");
  check_distinct({flags.json, flags.csv, flags.html, flags.svg});
  for (const std::string& file : {flags.json, flags.csv, flags.html, flags.svg})
    if (!file.empty()) check_writable(file);
  std::error_code failed;
  if (!flags.pictures.empty()) std::filesystem::create_directories(flags.pictures, failed);
  if (failed) throw InputError({flags.pictures}, "cannot be made a folder: " + failed.message());
}

/// All of them, so that what is wrong with any is told before the first takes its time.
std::vector<Scene> checked_scenes(const BenchFlags& flags) {
  std::vector<Scene> scenes;
  for (const std::string& file : flags.scenes) {
    scenes.push_back(load_scene(file));
    check_bench_scene(flags, scenes.back());
  }
  return scenes;
}

void write_pictures(const std::filesystem::path& folder, const BenchScene& scene) {
  const auto write = [&](const std::string& name, const Image& image) {
    write_image(folder / fmt::format("{}.{}.png", scene.name, as_file_name(name)), image);
  };
  write("reference", scene.reference_image);
  for (const BenchCurve& curve : scene.curves)
    if (curve.equal_time) write(curve.name, curve.equal_time->image);
}

int bench(const BenchFlags& flags, const std::string& command) {
  check_flags(flags);
  std::vector<Scene> scenes = checked_scenes(flags);
  BenchReport report{CASTRAY_VERSION, cpu_name(),
                     command,         flags.threads > 0 ? flags.threads : available_threads(),
                     flags.seeds,     {}};
  BenchMeter meter(flags.quiet);
  for (std::size_t i = 0; i < scenes.size(); ++i) {
    report.scenes.push_back(bench_scene(flags, std::exchange(scenes[i], {}), flags.scenes[i], meter));
    // After each scene, so that a long benchmark that is stopped leaves what it has.
    if (!flags.json.empty()) write_file(flags.json, bench_json(report));
    if (!flags.csv.empty()) write_file(flags.csv, bench_csv(report));
    if (!flags.html.empty()) write_file(flags.html, bench_html(report));
    if (!flags.svg.empty()) write_file(flags.svg, bench_svg(report));
    if (!flags.pictures.empty()) write_pictures(flags.pictures, report.scenes.back());
  }
  meter.clear();
  fmt::print("{}", bench_table(report));
  return 0;
}

}  // namespace

Run add_bench(Arguments& arguments, const CommonFlags& common) {
  const auto flags = std::make_shared<BenchFlags>();
  arguments.add_positional("SCENE", flags->scenes, "scene files").required();
  arguments.add("--config", flags->configurations, "NAME=FLAGS",
                "castray with these rendering flags; repeatable [castray=]");
  arguments.add(
      "--peer", flags->peers, "NAME=COMMAND",
      "another renderer; {scene} {spp} {seed} {out} {width} {height} {threads} are filled in; it writes a "
      ".pfm to {out} and prints 'seconds: X'; repeatable");
  arguments.add("--spp", flags->spp, "N,...", "budgets in samples per pixel [4,16,64]").separated_by(',');
  arguments.add("--seconds", flags->seconds, "X,...", "budgets in seconds of rendering").separated_by(',');
  arguments.add("--seeds", flags->seeds, "N", "renders per budget; medians are shown [8]");
  arguments.add("--size", flags->size, "WxH", "in pixels [the references', else the scene's]");
  arguments.add("-t,--threads", flags->threads, "N", "of castray's own renders [all]");
  arguments.add_switch("--ablation", flags->ablation, "also measure with each technique off in turn");
  arguments.add("--equal-time", flags->equal_time, "X",
                "seconds for the pictures and FLIP [the slowest one's smallest budget]");
  arguments.add("--reference", flags->reference, "A,B",
                "two independent images; {scene} stands for the scene's name [made, and kept in the cache]");
  arguments.add("--reference-spp", flags->reference_spp, "N", "of each reference made [1024]");
  arguments.add("--reference-flags", flags->reference_flags, "FLAGS",
                "rendering flags of the references made [--reuse off]");
  arguments.add("--cache", flags->cache, "FOLDER", "where the references made are kept [~/.cache/castray]");
  arguments
      .add("--mask", flags->mask, "emitters|none",
           "errors of the pixels away from directly seen emitters, or of all [emitters]")
      .one_of({"emitters", "none"});
  arguments.add("--json", flags->json, "FILE", "write all numbers here");
  arguments.add("--csv", flags->csv, "FILE", "write the medians here");
  arguments.add("--html", flags->html, "FILE", "write a self-contained page here");
  arguments.add("--svg", flags->svg, "FILE", "write the plots here");
  arguments.add("--pictures", flags->pictures, "FOLDER",
                "write the pictures at equal time here, as SCENE.NAME.png");
  return [flags, &common] {
    flags->quiet = common.quiet;
    if (flags->spp.empty() && flags->seconds.empty()) flags->spp = {4, 16, 64};
    if (flags->configurations.empty()) flags->configurations = {"castray="};
    return bench(*flags, command_line());
  };
}

}  // namespace castray::cli
