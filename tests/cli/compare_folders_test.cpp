#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "core/files.h"
#include "run_castray.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;

namespace {

/// out/a.pfm and references/a.pfm, equal.
struct Folders {
  TemporaryFolder folder;

  Folders() {
    for (const char* side : {"out", "references"}) {
      std::filesystem::create_directory(folder / side);
      write_image(folder / side / "a.pfm", test_image(12, 8));
    }
  }
  RunResult compare(std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"compare", "out", "references", "--max", "mse=0"});
    return run_castray(more, folder.path());
  }
};

}  // namespace

TEST_CASE(
    "folders: whatever cannot be compared is told by name, with exit code 2, and the rest is compared") {
  const Folders folders;
  const auto& folder = folders.folder;
  CHECK(folders.compare().exit_code == 0);
  write_file(folder / "out/notes.txt", "not an image");
  CHECK(folders.compare().exit_code == 0);

  std::string says;
  SECTION("a missing image") {
    write_image(folder / "references/b.pfm", test_image(2, 2));
    says = "ERROR b.pfm  out/b.pfm: does not exist";
  }
  SECTION("an image without a reference") {
    write_image(folder / "out/b.pfm", test_image(2, 2));
    says = "ERROR b.pfm  references/b.pfm: does not exist";
  }
  SECTION("another size") {
    write_image(folder / "out/b.pfm", test_image(2, 2));
    write_image(folder / "references/b.pfm", test_image(2, 3));
    says = "the image is 2x2, the reference 2x3";
  }
  SECTION("a broken file") {
    write_image(folder / "references/b.png", test_image(2, 2));
    write_file(folder / "out/b.png", "\x89PNG\r\n\x1a\n");
    says = "out/b.png: is";
  }
  SECTION("a folder by the name of an image") {
    write_image(folder / "references/b.pfm", test_image(2, 2));
    std::filesystem::create_directory(folder / "out/b.pfm");
    says = "ERROR b.pfm  out/b.pfm: ";
  }
  const RunResult result = folders.compare({"--junit", "j.xml", "--html", "p.html", "--json", "r.json"});
  CHECK(result.exit_code == 2);
  CHECK_THAT(result.out, Contains(says) && Contains("pass  a.pfm") && Contains("1 of 2 images pass"));
  CHECK_THAT(read_file(folder / "j.xml"), Contains("tests=\"2\" failures=\"0\" errors=\"1\""));
  const auto json = nlohmann::json::parse(read_file(folder / "r.json"));
  CHECK(json["pass"] == false);
  CHECK(json["comparisons"][1].contains("error"));
}

TEST_CASE("folders: one that differs and one that cannot be compared is exit code 2") {
  const Folders folders;
  write_image(folders.folder / "out/a.pfm", test_image(12, 8, 2));
  CHECK(folders.compare().exit_code == 1);
  write_image(folders.folder / "out/b.pfm", test_image(2, 2));
  CHECK(folders.compare().exit_code == 2);
}

TEST_CASE("folders: none, an empty one, and limits of images that are not there") {
  const Folders folders;
  const auto run = [&](const std::vector<std::string>& arguments) {
    const RunResult result = run_castray(arguments, folders.folder.path());
    CHECK(result.exit_code == 2);
    CHECK(result.error_lines() == 1);
    return result.err;
  };
  std::filesystem::create_directory(folders.folder / "empty");
  CHECK_THAT(run({"compare", "empty", "references"}), Contains("empty: holds no images"));
  CHECK_THAT(run({"compare", "out", "absent"}), Contains("absent"));
  CHECK_THAT(run({"compare", "absent", "gone"}), Contains("absent"));
  write_file(folders.folder / "limits.json", R"({"images": {"aa.pfm": {"max": {"mse": 1}}}})");
  CHECK_THAT(
      run({"compare", "out", "references", "--limits", "limits.json"}),
      Contains("limits.json: has limits of 'aa.pfm', which is in neither folder; did you mean 'a.pfm'"));
}

TEST_CASE("JUnit stays XML whatever images are called") {
  const Folders folders;
  const std::string name = "out/<&\"\x01\xff\xc3\xa9>.pfm";
  write_image(folders.folder / name, test_image(2, 2));
  CHECK(folders.compare({"--junit", "j.xml"}).exit_code == 2);
  CHECK_THAT(read_file(folders.folder / "j.xml"),
             Contains("name=\"&lt;&amp;&quot; \xef\xbf\xbd\xc3\xa9&gt;.pfm\""));
}
