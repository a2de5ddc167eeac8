#pragma once

#include <fcntl.h>
#include <stdlib.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <mutex>
#include <string>
#include <thread>

/// A terminal of some columns and rows; what is written to it is collected.
class Terminal {
 public:
  explicit Terminal(int columns, int rows = 24) : master_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    grantpt(master_);
    unlockpt(master_);
    slave_ = open(ptsname(master_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    resize(columns, rows);
    reader_ = std::thread([this] {
      char buffer[4096];
      for (ssize_t n; (n = read(master_, buffer, sizeof buffer)) > 0;) {
        const std::lock_guard lock(mutex_);
        text_.append(buffer, static_cast<std::size_t>(n));
      }
    });
  }
  ~Terminal() { text(); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  std::string name() const { return ptsname(master_); }
  /// The programs that it controls get SIGWINCH.
  void resize(int columns, int rows) const {
    const winsize size{static_cast<unsigned short>(rows), static_cast<unsigned short>(columns), 0, 0};
    ioctl(master_, TIOCSWINSZ, &size);
  }
  /// As from its keyboard: "\x03" is Ctrl-C.
  bool type(const std::string& keys) const {
    return write(master_, keys.data(), keys.size()) == static_cast<ssize_t>(keys.size());
  }
  std::string text_so_far() const {
    const std::lock_guard lock(mutex_);
    return text_;
  }
  /// All that was written, once its writers have ended.
  const std::string& text() {
    if (slave_ >= 0) close(slave_), slave_ = -1;
    if (reader_.joinable()) reader_.join(), close(master_);
    return text_;
  }

 private:
  int master_, slave_ = -1;
  mutable std::mutex mutex_;
  std::string text_;
  std::thread reader_;
};
