// What shells complete, and the manual page, are made from the same flags as --help.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <string>

#include "cli/command_help.h"
#include "run_castray.h"

namespace {

using castray::cli::CommandHelp;
using castray::cli::FlagHelp;

/// What bash offers behind "castray `words`", the last of which is begun.
std::string bash_offers(const std::string& words) {
  const TemporaryFolder folder;
  std::ofstream(folder / "complete") << run_castray({"completions", "bash"}, folder.path()).out;
  std::ofstream(folder / "a scene.json") << "{}";
  std::ofstream(folder / "try") << "source ./complete\nCOMP_WORDS=(castray " << words
                                << ")\nCOMP_CWORD=$((${#COMP_WORDS[@]} - 1))\n_castray\n"
                                << "for word in \"${COMPREPLY[@]}\"; do echo \"$word\"; done >offered\n";
  const std::string command = "cd '" + folder.path().string() + "' && bash ./try";
  REQUIRE(std::system(command.c_str()) == 0);
  std::ifstream offered(folder / "offered");
  return {std::istreambuf_iterator<char>(offered), {}};
}

/// Whether a shell that may be missing here accepts `text` as a script.
bool shell_accepts(const std::string& shell, const std::string& flag, const std::string& text) {
  const TemporaryFolder folder;
  std::ofstream(folder / "script") << text;
  if (std::system(("command -v " + shell + " >/dev/null").c_str()) != 0) return true;
  return std::system((shell + " " + flag + " '" + (folder / "script").string() + "'").c_str()) == 0;
}

}  // namespace

TEST_CASE("bash completes commands, flags, values and files") {
  CHECK(bash_offers("re") == "render\n");
  CHECK(bash_offers("render --sam") == "--samples\n--sampler\n");
  CHECK(bash_offers("render --sampler ''") == "sobol\nindependent\n");
  CHECK(bash_offers("render --sampler i") == "independent\n");
  CHECK(bash_offers("render --spp ''") == "");
  CHECK(bash_offers("render a") == "a scene.json\n");
  CHECK(bash_offers("convert -o a") == "a scene.json\n");
  CHECK(bash_offers("compare --he") == "--help\n--heatmap\n");
}

TEST_CASE("a metavar tells the values that can be offered") {
  const auto choices = [](const std::string& metavar) {
    return FlagHelp{{"--x"}, metavar, "", ""}.choices();
  };
  CHECK(choices("auto|solid-angle|16") == std::vector<std::string>{"auto", "solid-angle", "16"});
  CHECK(choices("srgb|gamma:G|X") == std::vector<std::string>{"srgb"});
  CHECK(choices("FILE").empty());
}

TEST_CASE("every flag of every command is completed and in the manual page") {
  const std::vector<CommandHelp> commands = castray::cli::command_helps();
  CHECK(commands.size() >= 8);
  const std::string bash = bash_completion(commands), zsh = zsh_completion(commands),
                    fish = fish_completion(commands), manual = manual_page(commands);
  for (const CommandHelp& command : commands) {
    CHECK_THAT(manual, Catch::Contains(".SS castray " + command.name + "\n"));
    for (const FlagHelp& flag : command.flags) {
      if (flag.positional()) continue;
      for (const std::string& name : flag.names) {
        INFO(command.name << " " << name);
        CHECK_THAT(bash, Catch::Contains(name));
        CHECK_THAT(zsh, Catch::Contains(name + "["));
        CHECK_THAT(fish, Catch::Contains("_from " + command.name) &&
                             Catch::Contains(name.starts_with("--") ? " -l " + name.substr(2) + " "
                                                                    : " -s " + name.substr(1) + " "));
        std::string escaped;
        for (const char c : name) escaped += c == '-' ? std::string("\\-") : std::string(1, c);
        CHECK_THAT(manual, Catch::Contains("\\fB" + escaped + "\\fR"));
      }
    }
  }
  CHECK(shell_accepts("bash", "-n", bash));
  CHECK(shell_accepts("zsh", "-n", zsh));
  CHECK(shell_accepts("fish", "--no-execute", fish));
}
