// Every command of README.md, CONTRIBUTING.md and docs/*.md is run, after those that precede it on its page.
// A block of commands is indented by four spaces. In front of it may stand
//
//     <!-- long: why -->        run by ./test --long
//     <!-- elsewhere: why -->   not run here; `why` says what runs it, or what it would need
//
// A comment "# exit N" behind a command tells an exit code that is not 0. Renders are made small: see
// `small_castray`.
#include <catch2/catch.hpp>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>

#include "castray/error.h"
#include "cli/command_help.h"
#include "cli/command_line.h"
#include "markdown.h"
#include "temporary_folder.h"
#include "words.h"

using namespace castray;
namespace fs = std::filesystem;

namespace {

/// castray as the pages call it, but for the size of what it renders and the effort of benchmarks.
constexpr const char* small_castray = R"(#!/usr/bin/env bash
case "${1-}" in
  render) case " $* " in *" --crop "* | *" --size "*) ;; *) set -- "$@" --size 64x64 ;; esac ;;
  bench) set -- "$@" --size 32x32 --seeds 1 --reference-spp 8 --cache cache ;;
  "") set -- render scenes/cornell_box.json -o cornell.png --size 64x64 ;;
esac
exec ")" CASTRAY_PROGRAM R"(" "$@"
)";

/// A folder that looks like this project once it is built.
class Checkout {
 public:
  Checkout() {
    for (const char* name : {"scenes", "models", "tests", "docs", "bench", "packages.txt"})
      fs::create_symlink(fs::path(CASTRAY_ROOT) / name, folder_ / name);
    fs::create_directories(folder_ / "build/release");
    for (const auto& entry : fs::directory_iterator(CASTRAY_BUILD))
      if (entry.path().filename().string().starts_with("castray-"))
        fs::create_symlink(entry.path(), folder_ / "build/release" / entry.path().filename());
    write_program("build/release/castray");
    write_program("run");
  }

  /// The exit code of a command; what it said is in `said`.
  int run(const std::string& command) {
    std::ofstream(folder_ / ".command") << "PATH=$PWD/build/release:$PATH\n" << command << "\n";
    const std::string here =
        "cd '" + folder_.path().string() + "' && HOME=$PWD bash .command >.said 2>&1 </dev/null";
    const int status = std::system(here.c_str());
    said = read_file(folder_ / ".said");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  std::string said;

 private:
  void write_program(const char* name) {
    std::ofstream(folder_ / name) << small_castray;
    fs::permissions(folder_ / name, fs::perms::owner_all);
  }

  TemporaryFolder folder_;
};

int expected_exit_code(const std::string& command) {
  std::smatch found;
  return std::regex_search(command, found, std::regex("# exit ([0-9]+)")) ? std::stoi(found[1]) : 0;
}

/// Runs the pages' commands. Those of `long` blocks are left out, but not what stands before and after them,
/// unless `all`.
void run_pages(bool all) {
  std::size_t commands = 0;
  for (const fs::path& page : pages()) {
    Checkout checkout;
    for (const CommandBlock& block : command_blocks(page)) {
      if (block.mark == "elsewhere" || (block.mark == "long" && !all)) continue;
      for (const std::string& command : block.commands) {
        const int exit_code = checkout.run(command);
        INFO(page.filename().string() << ":" << block.line << ": " << command << "\n" << checkout.said);
        CHECK(exit_code == expected_exit_code(command));
        ++commands;
      }
    }
  }
  CHECK(commands > 20);
}

/// What is not known of a command line; its files need not exist, nor be named.
std::string unknown_in(const std::vector<std::string>& words) {
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  try {
    cli::parse_command_line(static_cast<int>(argv.size()), argv.data());
  } catch (const InputError& error) {
    if (std::string(error.what()).starts_with("unknown")) return error.what();
  }
  return "";
}

}  // namespace

TEST_CASE("every command of the pages runs as written, after those before it") { run_pages(false); }

TEST_CASE("every command of the pages runs, the long ones too", "[long]") { run_pages(true); }

TEST_CASE("a mark in front of commands is one that is known, and says why") {
  for (const fs::path& page : pages())
    for (const std::string& line : lines_of(page))
      if (const std::string mark = mark_of(line); !mark.empty()) {
        INFO(page.filename().string() << ": " << line);
        CHECK((mark == "long" || mark == "elsewhere"));
        CHECK(line.find(": ") != line.npos);
      }
}

TEST_CASE("commands in running text, and the flags that it names, are castray's own") {
  std::set<std::string> flags = {"--browser", "--long",   "--preset", "--install",
                                 "--prefix",  "--cflags", "--libs"};
  for (const cli::CommandHelp& command : cli::command_helps())
    for (const cli::FlagHelp& flag : command.flags) flags.insert(flag.names.begin(), flag.names.end());
  flags.insert({"--help", "--version"});
  for (const fs::path& page : pages())
    for (const std::string& code : inline_code(page)) {
      INFO(page.filename().string() << ": " << code);
      const std::vector<std::string> words = words_of(code);
      if (words.size() > 1 && words[0] == "castray" && code.find("...") == code.npos &&
          code.find('|') == code.npos)
        CHECK(unknown_in(words) == "");
      if (!words.empty() && words[0].starts_with("--")) {
        const std::string flag = words[0].substr(0, words[0].find('='));
        CHECK(flags.contains(flag));
      }
    }
}

TEST_CASE("what the pages link to is there") {
  const std::regex link(R"(\]\(([^)#]+)[^)]*\))");
  for (const fs::path& page : pages())
    for (const std::string& line : lines_of(page))
      for (std::sregex_iterator found(line.begin(), line.end(), link), end; found != end; ++found) {
        const std::string target = (*found)[1];
        if (target.find("://") != target.npos) continue;
        INFO(page.filename().string() << ": " << target);
        CHECK(fs::exists(page.parent_path() / target));
      }
}
