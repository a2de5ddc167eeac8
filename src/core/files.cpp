#include "core/files.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <ext/stdio_filebuf.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>

#include "castray/error.h"

namespace castray {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& file, const std::string& what) {
  throw InputError({file.string()}, what);
}

std::string reason(int error) { return error ? std::strerror(error) : "unknown error"; }

/// Bytes that are read of what has no length of its own, a pipe or a device.
constexpr std::size_t longest_stream = 1 << 28;

std::uintmax_t memory_size() {
  return static_cast<std::uintmax_t>(sysconf(_SC_PHYS_PAGES)) *
         static_cast<std::uintmax_t>(sysconf(_SC_PAGESIZE));
}

/// The file that a chain of symbolic links ends in; it need not exist.
fs::path link_target(const fs::path& file) {
  std::error_code ignored;
  fs::path target = file;
  for (int links = 0; links < 40 && fs::is_symlink(target, ignored); ++links) {
    const fs::path next = fs::read_symlink(target, ignored);
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target;
}

fs::path folder_of(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

bool is_special(const fs::path& file) {
  std::error_code ignored;
  const fs::file_status status = fs::status(file, ignored);
  return fs::exists(status) && !fs::is_regular_file(status);
}

/// What `write` writes. It may seek, as writers of EXR do, which pipes and devices cannot.
std::string bytes_of(const std::function<void(std::ostream&)>& write) {
  std::ostringstream bytes;
  write(bytes);
  return std::move(bytes).str();
}

/// Writes to `out`, which goes to `file`. Throws InputError unless all of it arrives.
void write_stream(const fs::path& file, std::ostream& out, const std::function<void(std::ostream&)>& write) {
  errno = 0;
  write(out);
  out.flush();
  if (!out) fail(file, "cannot be written: " + reason(errno) + "; free some space or write elsewhere");
}

/// Makes a renaming in `folder` last. A file system without that guarantee is no error.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

/// A new, empty file in `folder` that is gone again unless it takes the target's place. Where the file system
/// can do that it has no name until then, so that a killed process leaves nothing behind.
class TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& folder) : folder_(folder) {
    descriptor_ = ::open(folder.c_str(), O_WRONLY | O_TMPFILE | O_CLOEXEC, 0666);
    if (descriptor_ >= 0 && ::access(link().c_str(), F_OK) == 0) return;
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
    give_name([&](const fs::path& name) {
      descriptor_ = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      return descriptor_ >= 0;
    });
  }
  ~TemporaryFile() {
    std::error_code ignored;
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!path_.empty()) fs::remove(path_, ignored);
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int error() const { return error_; }

  /// Returns when the bytes are on the disk. `file` is for messages.
  void write(const fs::path& file, const std::function<void(std::ostream&)>& write) {
    __gnu_cxx::stdio_filebuf<char> buffer(::dup(descriptor_), std::ios::out | std::ios::binary);
    std::ostream out(&buffer);
    if (!buffer.is_open()) fail(file, "cannot be opened for writing: " + reason(errno));
    write_stream(file, out, write);
    if (::fsync(descriptor_) != 0) fail(file, "cannot be written: " + reason(errno) + "; write elsewhere");
  }

  /// Returns when the new name, too, is on the disk.
  void take_place_of(const fs::path& target) {
    struct stat old;
    std::error_code error;
    if (::stat(target.c_str(), &old) == 0 && ::fchmod(descriptor_, old.st_mode & 07777) != 0)
      fail(target, "cannot be replaced: " + reason(errno));
    if (path_.empty())
      give_name([&](const fs::path& name) {
        return ::linkat(AT_FDCWD, link().c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
      });
    if (error_) fail(target, "cannot be replaced: " + reason(error_));
    fs::rename(path_, target, error);
    if (error) fail(target, "cannot be replaced: " + error.message());
    path_.clear();
    sync_folder(folder_);
  }

 private:
  std::string link() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  /// Finds a name that is free. `take` takes it, or returns false with `errno`.
  template <class Take>
  void give_name(Take take) {
    static std::atomic<unsigned> number{0};
    for (int tries = 0; tries < 1000; ++tries) {
      path_ = folder_ / (".castray-" + std::to_string(getpid()) + "-" + std::to_string(number++) + ".tmp");
      if (take(path_)) return;
      error_ = errno;
      if (error_ != EEXIST) break;
    }
    path_.clear();
  }

  fs::path folder_, path_;  ///< no path: it has no name
  int descriptor_ = -1;
  int error_ = 0;
};

/// Makes `previous` another name of what `file` is. Where there are no hard links, `file` is renamed.
void keep(const fs::path& file, const fs::path& previous) {
  std::error_code error;
  if (!fs::exists(file, error)) return;
  const fs::path name = previous.string() + ".tmp";
  fs::remove(name, error);
  fs::create_hard_link(file, name, error);
  if (!error)
    fs::rename(name, previous, error);
  else
    fs::rename(file, previous, error);
  if (error) fail(previous, "cannot be written: " + error.message());
}

/// Opening a named pipe waits for its reader.
void write_special(const fs::path& file, const fs::path& target, const std::string& bytes) {
  errno = 0;
  std::ofstream out(target, std::ios::binary);
  if (!out) fail(file, "cannot be opened for writing: " + reason(errno));
  write_stream(file, out, [&bytes](std::ostream& stream) { stream << bytes; });
}

void write_standard_output(const fs::path& file, const std::string& bytes) {
  errno = 0;
  if (std::fwrite(bytes.data(), 1, bytes.size(), stdout) != bytes.size() || std::fflush(stdout) != 0)
    fail(file, "cannot be written: " + reason(errno));
}

}  // namespace

std::string suffix_of(const fs::path& file) {
  std::string suffix = file.extension().string();
  std::transform(suffix.begin(), suffix.end(), suffix.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return suffix;
}

namespace {

std::ifstream open_to_read(const fs::path& file) {
  std::error_code ignored;
  if (fs::is_directory(file, ignored)) fail(file, "is a folder; give a file");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) fail(file, errno == ENOENT ? "does not exist" : "cannot be read: " + reason(errno));
  return in;
}

}  // namespace

std::string as_file_name(std::string text) {
  for (char& c : text)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '-' && c != '.') c = '_';
  return text;
}

std::string read_file(const fs::path& file) {
  std::ifstream in = open_to_read(file);
  std::error_code ignored;
  const std::uintmax_t length = fs::is_regular_file(file, ignored) ? fs::file_size(file, ignored) : 0;
  if (length > memory_size()) fail(file, "is longer than this machine's memory");
  std::string bytes;
  bytes.reserve(length);
  char block[1 << 16];
  while (in.read(block, sizeof block) || in.gcount() > 0) {
    bytes.append(block, static_cast<std::size_t>(in.gcount()));
    if (length == 0 && bytes.size() > longest_stream) fail(file, "does not end; give a regular file");
  }
  if (in.bad()) fail(file, "cannot be read: " + reason(errno));
  return bytes;
}

std::string read_head(const fs::path& file, std::size_t at_least, char end) {
  std::ifstream in = open_to_read(file);
  std::string head(at_least, '\0'), rest;
  in.read(head.data(), static_cast<std::streamsize>(at_least));
  head.resize(static_cast<std::size_t>(in.gcount()));
  if (in && std::getline(in, rest, end)) head += rest + (in.eof() ? "" : std::string(1, end));
  if (in.bad()) fail(file, "cannot be read: " + reason(errno));
  return head;
}

bool is_standard_output(const fs::path& file) {
  const std::string name = file.string();
  return name == "-" || name == "/dev/stdout" ||
         (name.ends_with(":-") && name.find('/') == std::string::npos);
}

void check_writable(const fs::path& file) {
  if (is_standard_output(file)) return;
  if (file.empty()) throw InputError("an output file's name is empty; give a path");
  const fs::path target = link_target(file), folder = folder_of(target);
  std::error_code ignored;
  if (!fs::exists(folder, ignored))
    fail(file, "the folder " + folder.string() + " does not exist; create it first");
  if (!fs::is_directory(folder, ignored)) fail(file, folder.string() + " is not a folder");
  if (fs::is_directory(target, ignored) || !target.has_filename())
    fail(file, "is a folder; give a file name");
  const fs::file_status status = fs::status(target, ignored);
  constexpr fs::perms any_write = fs::perms::owner_write | fs::perms::group_write | fs::perms::others_write;
  if (fs::exists(status) &&
      ((status.permissions() & any_write) == fs::perms::none || ::access(target.c_str(), W_OK) != 0))
    fail(file, "is write-protected; make it writable or give another name");
  if (!is_special(target) && ::access(folder.c_str(), W_OK | X_OK) != 0)
    fail(file, "the folder " + folder.string() + " is not writable");
}

namespace {

/// `write_file`, with `previous` if it is not empty.
void replace_file(const fs::path& file, const fs::path& previous,
                  const std::function<void(std::ostream&)>& write) {
  check_writable(file);
  const fs::path target = link_target(file);
  if (is_special(target)) return write_special(file, target, bytes_of(write));
  TemporaryFile temporary(folder_of(target));
  if (temporary.error()) fail(file, "cannot be written: " + reason(temporary.error()));
  temporary.write(file, write);
  if (!previous.empty()) keep(target, previous);
  temporary.take_place_of(target);
}

}  // namespace

void write_file(const fs::path& file, const std::function<void(std::ostream&)>& write) {
  if (is_standard_output(file)) return write_standard_output(file, bytes_of(write));
  replace_file(file, {}, write);
}

void write_file(const fs::path& file, std::string_view bytes) {
  write_file(file, [bytes](std::ostream& out) {
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  });
}

void write_file_keeping(const fs::path& file, const fs::path& previous,
                        const std::function<void(std::ostream&)>& write) {
  replace_file(file, previous, write);
}

}  // namespace castray
