#include "cli/terminal_preview.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "castray/error.h"
#include "cli/interrupt.h"

namespace castray::cli {

namespace {

constexpr const char* own_screen = "\x1b[?1049h\x1b[?25l\x1b[2J";
constexpr const char* former_screen = "\x1b[0m\x1b[?25h\x1b[?1049l";

/// Mean of the pixels that one of width x height cells covers.
Vec3f cell_mean(const Image& image, int x, int y, int width, int height) {
  const auto range = [](int i, int cells, int pixels) {
    const int begin = static_cast<int>(static_cast<long long>(i) * pixels / cells);
    const int end = static_cast<int>(static_cast<long long>(i + 1) * pixels / cells);
    return std::pair(std::min(begin, pixels - 1), std::max(end, std::min(begin, pixels - 1) + 1));
  };
  const auto [x0, x1] = range(x, width, image.width);
  const auto [y0, y1] = range(y, height, image.height);
  Vec3d sum;
  for (int j = y0; j < y1; ++j)
    for (int i = x0; i < x1; ++i) sum += Vec3d(image.at(i, j));
  return Vec3f(sum / (static_cast<double>(x1 - x0) * (y1 - y0)));
}

int byte_of(float value) { return static_cast<int>(std::lround(255 * value)); }

}  // namespace

std::string half_blocks(const Image& image, const Display& display, int columns, int rows) {
  const double scale = std::min(static_cast<double>(columns) / image.width, 2.0 * rows / image.height);
  const int width = std::clamp(static_cast<int>(image.width * scale), 1, std::max(columns, 1));
  const int height = std::clamp(static_cast<int>(image.height * scale), 1, std::max(2 * rows, 1));
  Image cells(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) cells.at(x, y) = cell_mean(image, x, y, width, height);
  cells = displayed(cells, display);
  std::string text;
  const auto color = [&](char kind, const Vec3f& v) {
    text += fmt::format("\x1b[{}8;2;{};{};{}m", kind, byte_of(v.x), byte_of(v.y), byte_of(v.z));
  };
  for (int y = 0; y < height; y += 2) {
    for (int x = 0; x < width; ++x) {
      color('3', cells.at(x, y));
      if (y + 1 < height)
        color('4', cells.at(x, y + 1));
      else
        text += "\x1b[49m";
      text += "\u2580";
    }
    text += "\x1b[0m\r\n";
  }
  return text;
}

TerminalPreview::TerminalPreview(const Display& display) : display_(display) {
  if (!isatty(STDERR_FILENO)) throw InputError("--preview terminal: the standard error is no terminal");
  write_when_killed(former_screen);
  fmt::print(stderr, "{}", own_screen);
}

TerminalPreview::~TerminalPreview() {
  fmt::print(stderr, "{}", former_screen);
  std::fflush(stderr);
  write_when_killed(nullptr);
}

void TerminalPreview::show(const Image& image) {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0 || size.ws_row < 2) return;
  if (size.ws_col != columns_ || size.ws_row != rows_) fmt::print(stderr, "\x1b[2J");
  columns_ = size.ws_col, rows_ = size.ws_row;
  fmt::print(stderr, "\x1b[H{}\x1b[{};1H", half_blocks(image, display_, columns_, rows_ - 1), rows_);
  std::fflush(stderr);
}

}  // namespace castray::cli
