#include <catch2/catch.hpp>

#include "castray/film.h"
#include "core/files.h"
#include "run_castray.h"
#include "test_image.h"

using namespace castray;
using Catch::Contains;

TEST_CASE("accept puts images in the place of their references") {
  const TemporaryFolder folder;
  const auto run = [&](const std::vector<std::string>& arguments) {
    return run_castray(arguments, folder.path());
  };
  write_image(folder / "a.pfm", test_image(12, 8));
  write_image(folder / "b.pfm", test_image(12, 8, 2));
  CHECK(run({"accept", "b.pfm", "a.pfm"}).exit_code == 0);
  CHECK(read_file(folder / "a.pfm") == read_file(folder / "b.pfm"));
  CHECK_THAT(run({"accept", "b.pfm", "a.pfm"}).out, Contains("same"));
  CHECK(run({"accept", "b.pfm", "a.png"}).exit_code == 2);
  write_file(folder / "broken.pfm", "PF");
  CHECK(run({"accept", "broken.pfm", "a.pfm"}).exit_code == 2);
  CHECK(read_file(folder / "a.pfm") == read_file(folder / "b.pfm"));
}

TEST_CASE("accept takes folders, makes those that are missing, and keeps variances beside their images") {
  const TemporaryFolder folder;
  const auto run = [&](const std::vector<std::string>& arguments) {
    return run_castray(arguments, folder.path());
  };
  std::filesystem::create_directories(folder / "out/sub");
  write_image(folder / "out/a.pfm", test_image(12, 8));
  write_image(folder / "out/a.variance.pfm", test_image(12, 8, 2));
  write_image(folder / "out/sub/b.exr", test_image(12, 8));
  const RunResult first = run({"accept", "out", "references"});
  CHECK(first.exit_code == 0);
  CHECK_THAT(first.out, Contains("new       references/a.pfm") &&
                            Contains("new       references/a.variance.pfm") &&
                            Contains("new       references/sub/b.exr"));
  CHECK(run({"compare", "out", "references", "--max", "mse=0"}).exit_code == 0);
  CHECK_THAT(first.out, !Contains("a sixteenth"));
  std::filesystem::create_directory(folder / "films");
  write_film(folder / "films/f.film", Film({8, 8, 0, 0, 8, 8}, 1));
  CHECK_THAT(run({"accept", "films", "kept"}).out, Contains("a sixteenth"));
  write_image(folder / "out/sub/b.exr", test_image(12, 8, 3));
  CHECK(run({"compare", "out", "references", "--max", "mse=0"}).exit_code == 1);
  CHECK_THAT(run({"accept", "out", "references"}).out,
             Contains("same      references/a.pfm") && Contains("replaced  references/sub/b.exr"));
  CHECK(run({"compare", "out", "references", "--max", "mse=0"}).exit_code == 0);
  CHECK(run({"accept", "out", "references/a.pfm"}).exit_code == 2);
}
