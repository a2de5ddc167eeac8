#pragma once

#include <string>

#include "castray/image.h"

namespace castray::cli {

/// The image in at most `columns` x `rows` characters of a terminal with 24-bit colour: each shows two
/// pixels, the upper as the colour of a half block, the lower as its background. Lines end with "\r\n".
std::string half_blocks(const Image& image, const Display& display, int columns, int rows);

/// Shows an image on the terminal that stderr is, on a screen of its own; the terminal's own screen is back
/// when this object dies. The last line stays free for progress.
class TerminalPreview {
 public:
  /// Throws InputError where stderr is no terminal.
  explicit TerminalPreview(const Display& display);
  ~TerminalPreview();
  TerminalPreview(const TerminalPreview&) = delete;
  TerminalPreview& operator=(const TerminalPreview&) = delete;

  /// In the terminal's present size.
  void show(const Image& image);

 private:
  Display display_;
  int columns_ = 0, rows_ = 0;
};

}  // namespace castray::cli
