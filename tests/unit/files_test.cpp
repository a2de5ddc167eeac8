#include "core/files.h"

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <csignal>
#include <fstream>
#include <ostream>

#include "castray/error.h"
#include "temporary_folder.h"

using namespace castray;
namespace fs = std::filesystem;

TEST_CASE("write_file replaces a file, keeps its permissions and leaves nothing beside it") {
  const TemporaryFolder folder;
  const fs::path file = folder / "out.txt";
  write_file(file, "old");
  fs::permissions(file, fs::perms::owner_read | fs::perms::owner_write);
  write_file(file, "new");
  CHECK(read_file(file) == "new");
  CHECK(fs::status(file).permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  CHECK(folder.names() == std::vector<std::string>{"out.txt"});
}

TEST_CASE("a failed write leaves the old file and no temporary one") {
  const TemporaryFolder folder;
  const fs::path file = folder / "out.txt";
  write_file(file, "old");
  CHECK_THROWS_AS(write_file(file,
                             [](std::ostream& out) {
                               out << "half";
                               throw InputError("stopped");
                             }),
                  InputError);
  CHECK(read_file(file) == "old");
  CHECK(folder.names() == std::vector<std::string>{"out.txt"});
}

TEST_CASE("a disk that fills up leaves the old file and no temporary one") {
  const TemporaryFolder folder;
  const fs::path file = folder / "out.txt";
  write_file(file, "old");
  rlimit limit{};
  getrlimit(RLIMIT_FSIZE, &limit);
  const rlimit small{1 << 12, limit.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &small);
  std::string message;
  try {
    write_file(file, std::string(1 << 20, 'x'));
  } catch (const InputError& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &limit);
  std::signal(SIGXFSZ, handler);
  CHECK_THAT(message, Catch::Contains("cannot be written: File too large"));
  CHECK(read_file(file) == "old");
  CHECK(folder.names() == std::vector<std::string>{"out.txt"});
}

TEST_CASE("a writer may go back in the file") {
  const TemporaryFolder folder;
  write_file(folder / "out", [](std::ostream& out) {
    out << "size ????" << std::string(1 << 16, '.');
    out.seekp(5);
    out << "64";
  });
  CHECK(read_file(folder / "out") == "size 64??" + std::string(1 << 16, '.'));
}

TEST_CASE("the suffix of a name is in lower case") {
  CHECK(suffix_of("a/BOX.OBJ") == ".obj");
  CHECK(suffix_of("a.b/box") == "");
}

TEST_CASE("a symbolic link is followed, a device is written to, a full one is an error") {
  const TemporaryFolder folder;
  write_file(folder / "real.txt", "old");
  fs::create_symlink("real.txt", folder / "link.txt");
  write_file(folder / "link.txt", "new");
  CHECK(fs::is_symlink(folder / "link.txt"));
  CHECK(read_file(folder / "real.txt") == "new");

  fs::create_symlink("/dev/null", folder / "null.txt");
  CHECK_NOTHROW(write_file(folder / "null.txt", "gone"));
  fs::create_symlink("/dev/full", folder / "full.txt");
  CHECK_THROWS_WITH(write_file(folder / "full.txt", "too much"), Catch::Contains("No space left on device"));
  CHECK(fs::is_character_file("/dev/full"));
}

TEST_CASE("an output path that cannot work is refused with its reason") {
  const TemporaryFolder folder;
  write_file(folder / "file", "");
  CHECK_THROWS_WITH(check_writable(folder / "absent/out.png"), Catch::Contains("does not exist"));
  CHECK_THROWS_WITH(check_writable(folder / "file/out.png"), Catch::Contains("is not a folder"));
  CHECK_THROWS_WITH(check_writable(folder.path()), Catch::Contains("is a folder"));
  CHECK_THROWS_WITH(check_writable(folder / "name/"), Catch::Contains("does not exist"));
  CHECK_THROWS_WITH(check_writable(""), Catch::Contains("empty"));
  fs::permissions(folder / "file", fs::perms::owner_read);
  CHECK_THROWS_WITH(check_writable(folder / "file"), Catch::Contains("write-protected"));
  CHECK_THROWS_WITH(read_file(folder.path()), Catch::Contains("is a folder"));
  CHECK_THROWS_WITH(read_file(folder / "absent"), Catch::Contains("does not exist"));
}
