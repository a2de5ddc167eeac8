#pragma once

#include <iosfwd>
#include <memory>
#include <span>
#include <vector>

#include "castray/image.h"

namespace castray {

/// Writes an image to a stream, the top rows first, in any number of pieces: to the same bytes.
class RowWriter {
 public:
  virtual ~RowWriter() = default;
  /// The next rows, as wide as the image.
  virtual void add(const Image& rows) = 0;
  /// After the last row.
  virtual void finish() {}
};

/// What is written besides pixels. `noise` and `passes`, of the whole image, outlive the writer.
struct WrittenImage {
  int width = 0, height = 0;
  const Display& display;
  const Metadata& metadata;
  const std::optional<Noise>& noise;
  const Passes& passes;
};

// One for each format. Stream and image outlive the writer, which writes its header at once.
std::unique_ptr<RowWriter> write_ppm(std::ostream& out, const WrittenImage& image);
std::unique_ptr<RowWriter> write_png(std::ostream& out, const WrittenImage& image);
std::unique_ptr<RowWriter> write_pfm(std::ostream& out, const WrittenImage& image);  ///< moves in the stream
std::unique_ptr<RowWriter> write_hdr(std::ostream& out, const WrittenImage& image);
std::unique_ptr<RowWriter> write_exr(std::ostream& out, const WrittenImage& image);

/// That of the format of `file`. Throws InputError where images are not written in it.
std::unique_ptr<RowWriter> row_writer(const std::filesystem::path& file, std::ostream& out,
                                      const WrittenImage& image);

/// A row of an image, and pixels as RGB of 8 or 16 bits, big-endian.
inline std::span<const Vec3f> row_of(const Image& image, int y) {
  return {&image.at(0, y), static_cast<std::size_t>(image.width)};
}
std::vector<unsigned char> quantised(std::span<const Vec3f> row, const Display& display);

}  // namespace castray
