#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "core/files.h"

using castray::read_file;
namespace fs = std::filesystem;

// What docs/architecture.md says of the source tree is so.

namespace {

const fs::path root = CASTRAY_ROOT;

using Folders = std::vector<std::string>;

/// Folders of src/ in the order of docs/architecture.md, and those that each may include.
struct Rules {
  Folders order;
  std::map<std::string, Folders> may_include;
};

/// The block "```include-rules" of a text: a line a folder, "FOLDER INCLUDED INCLUDED ...".
Rules rules_in(const std::string& text) {
  const std::string fence = "```include-rules\n";
  const std::size_t begin = text.find(fence) + fence.size();
  std::istringstream lines(text.substr(begin, text.find("```", begin) - begin));
  Rules rules;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string folder;
    words >> folder;
    rules.order.push_back(folder);
    for (std::string word; words >> word;) rules.may_include[folder].push_back(word);
  }
  return rules;
}

const Rules& rules() {
  static const Rules read = rules_in(read_file(root / "docs/architecture.md"));
  return read;
}

bool contains(const Folders& folders, const std::string& folder) {
  return std::find(folders.begin(), folders.end(), folder) != folders.end();
}

/// Code without comments and without the contents of strings, except those of #include.
std::string code_of(const std::string& text) {
  static const std::regex comment("//[^\n]*|/\\*[^]*?\\*/");
  return std::regex_replace(text, comment, "");
}

std::vector<std::string> matches(const std::string& text, const std::string& pattern, std::size_t group = 0) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator at(text.begin(), text.end(), regex), end; at != end; ++at)
    found.push_back((*at)[group]);
  return found;
}

/// What breaks the rules in a file of the project, named by its path below the root.
std::vector<std::string> violations(const std::string& path, const std::string& text) {
  const std::string code = code_of(text);
  const bool is_public = path.starts_with("include/");
  const std::string folder = is_public ? "" : path.substr(4, path.find('/', 4) - 4);
  std::vector<std::string> found;
  const auto add = [&](const std::string& what) { found.push_back(path + ": " + what); };

  for (const std::string& other : matches(code, "#include \"([a-z_]+)/", 1)) {
    if (other == "castray" || other == folder) continue;
    if (is_public || !rules().may_include.contains(folder) ||
        !contains(rules().may_include.at(folder), other))
      add("includes " + other + "/");
  }
  if (folder != "simd")
    for (const std::string& word :
         matches(code, "[a-z]*mmintrin\\.h|immintrin\\.h|\\b_mm[0-9]*_\\w+|__builtin_ia32\\w*|\\b__m[0-9]+\\w?"))
      add("intrinsic " + word + " outside simd/");
  if (folder != "cli")
    for (const std::string& word :
         matches(code, "\\b(fmt::print|std::c(out|err|log)|f?printf|f?puts|(std::)?(exit|abort|quick_exit))\\b"))
      add(word + " outside cli/");
  if (folder != "cli" && path != "src/core/files.cpp")
    for (const std::string& word : matches(code, "\\bofstream\\b|\\bfopen\\b"))
      add("opens an output file: " + word);
  return found;
}

std::vector<fs::path> sources(const fs::path& below) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root / below))
    if (entry.path().extension() == ".h" || entry.path().extension() == ".cpp")
      files.push_back(entry.path().lexically_relative(root));
  return files;
}

}  // namespace

TEST_CASE("every file keeps the rules of docs/architecture.md") {
  std::vector<std::string> found;
  for (const fs::path below : {"src", "include/castray"})
    for (const fs::path& file : sources(below))
      for (const std::string& violation : violations(file.string(), read_file(root / file)))
        found.push_back(violation);
  CHECK(found == std::vector<std::string>{});
}

TEST_CASE("the rules name each folder of src once, below all that it includes") {
  Folders folders;
  for (const auto& entry : fs::directory_iterator(root / "src"))
    folders.push_back(entry.path().filename().string());
  Folders named = rules().order;
  std::sort(folders.begin(), folders.end());
  std::sort(named.begin(), named.end());
  CHECK(named == folders);
  Folders above;
  for (const std::string& folder : rules().order) {
    if (rules().may_include.contains(folder))
      for (const std::string& other : rules().may_include.at(folder)) {
        INFO(folder << " includes " << other);
        CHECK(contains(above, other));
      }
    above.push_back(folder);
  }
}

TEST_CASE("what breaks a rule is found") {
  const auto count = [](const char* path, const char* text) { return violations(path, text).size(); };
  CHECK(count("src/core/x.h", "#include \"render/row_loop.h\"\n") == 1);
  CHECK(count("src/render/x.h", "#include \"core/text.h\"\n#include \"castray/film.h\"\n") == 0);
  CHECK(count("src/stranger/x.h", "#include \"core/text.h\"\n") == 1);
  CHECK(count("include/castray/x.h", "#include \"core/text.h\"\n") == 1);
  CHECK(count("src/geometry/x.cpp", "#include <immintrin.h>\nauto a = _mm_set1_ps(1);") == 2);
  CHECK(count("src/geometry/x.cpp", "__m256i a; auto b = __builtin_ia32_pause();") == 2);
  CHECK(count("src/simd/x.h", "auto a = _mm512_set1_ps(1);") == 0);
  CHECK(count("src/scene/x.cpp", "std::exit(2);") == 1);
  CHECK(count("src/render/x.cpp", "fmt::print(stderr, \"x\"); std::cerr << 1;") == 2);
  CHECK(count("src/image/x.cpp", "std::ofstream out(file);") == 1);
  CHECK(count("src/cli/x.cpp", "fmt::print(\"x\"); std::exit(2);") == 0);
  CHECK(count("src/render/x.cpp", "// fmt::print and std::exit are for cli\n") == 0);
}
