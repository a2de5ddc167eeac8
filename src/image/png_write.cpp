#include <zlib.h>
#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <new>
#include <ostream>
#include <string>
#include <vector>

#include "core/vector_clones.h"
#include "image/row_writer.h"

namespace castray {

namespace {

/// An image is packed in pieces of whole rows of at least so many bytes, whatever the threads that do it.
constexpr std::size_t bytes_of_piece = std::size_t{1} << 18;
constexpr int filters = 5;  ///< none, left, above, their mean, Paeth's choice (PNG 9.2)
/// Noise hardly compresses: zlib's fastest level gives files a few per cent larger in a quarter of the time.
constexpr int level = 1;

std::string big_endian(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 255);
  return bytes;
}

void write_chunk(std::ostream& out, const std::string& type, const std::string& data) {
  const std::string body = type + data;
  const uLong sum = crc32_z(crc32_z(0, nullptr, 0), reinterpret_cast<const Bytef*>(body.data()), body.size());
  out << big_endian(static_cast<std::uint32_t>(data.size())) << body
      << big_endian(static_cast<std::uint32_t>(sum));
}

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
}

/// ASCII is a tEXt chunk, other text an iTXt chunk: not compressed, of no language.
void write_text(std::ostream& out, const std::string& name, const std::string& value) {
  constexpr std::size_t longest = 79;
  const std::string key = name.substr(0, longest);
  if (is_ascii(value)) return write_chunk(out, "tEXt", key + '\0' + value);
  write_chunk(out, "iTXt", key + std::string(5, '\0') + value);
}

/// What is left of a row's bytes when those that a filter predicts are taken out. `pixel`: the bytes of one;
/// as many before each row are zero.
CASTRAY_VECTOR_CLONES
void take_out(int filter, const unsigned char* row, const unsigned char* above, std::size_t count,
              std::size_t pixel, unsigned char* __restrict rest) {
  const unsigned char *left = row - pixel, *corner = above - pixel;
  const auto write = [&](auto predicted) {
    for (std::size_t i = 0; i < count; ++i) rest[i] = static_cast<unsigned char>(row[i] - predicted(i));
  };
  switch (filter) {
    case 0:
      return write([](std::size_t) { return 0; });
    case 1:
      return write([=](std::size_t i) { return left[i]; });
    case 2:
      return write([=](std::size_t i) { return above[i]; });
    case 3:
      return write([=](std::size_t i) { return (left[i] + above[i]) / 2; });
    default:
      return write([=](std::size_t i) {
        const int a = std::abs(above[i] - corner[i]), b = std::abs(left[i] - corner[i]),
                  c = std::abs(left[i] + above[i] - 2 * corner[i]);
        const int other = b <= c ? above[i] : corner[i];
        return (a <= b) & (a <= c) ? left[i] : other;
      });
  }
}

/// The sum of the bytes as signed numbers without their signs: the less it is, the better they compress.
CASTRAY_VECTOR_CLONES
std::uint32_t size_of(const unsigned char* bytes, std::size_t count) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < count; ++i)
    sum += static_cast<std::uint32_t>(std::min<int>(bytes[i], 256 - bytes[i]));
  return sum;
}

/// Rows of bytes, before each as many zeros as a pixel has. The first row is the one above the others.
struct Rows {
  std::size_t pixel, count;  ///< bytes of a pixel, and of a row
  std::vector<unsigned char> bytes;

  std::size_t stride() const { return pixel + count; }
  std::size_t number() const { return bytes.size() / stride() - 1; }
  unsigned char* row(std::size_t y) { return &bytes[(y + 1) * stride() + pixel]; }
  const unsigned char* row(std::size_t y) const { return const_cast<Rows*>(this)->row(y); }

  /// Filtered, each after its filter's number.
  std::vector<unsigned char> filtered(std::size_t begin, std::size_t end) const {
    std::vector<unsigned char> result, best(count), other(count);
    result.reserve((end - begin) * (1 + count));
    for (std::size_t y = begin; y < end; ++y) {
      const unsigned char* above = row(y) - stride();
      int filter = 0;
      std::uint32_t least = ~0U;
      for (int i = 0; i < filters; ++i) {
        take_out(i, row(y), above, count, pixel, other.data());
        const std::uint32_t size = size_of(other.data(), count);
        if (size >= least) continue;
        least = size, filter = i;
        std::swap(best, other);
      }
      result.push_back(static_cast<unsigned char>(filter));
      result.insert(result.end(), best.begin(), best.end());
    }
    return result;
  }
};

/// A part of the stream of compressed bytes, which begins and ends at whole bytes.
struct Piece {
  std::string packed;
  uLong checksum = 0;  ///< of what it holds
  std::size_t length = 0;

  Piece() = default;
  Piece(const std::vector<unsigned char>& bytes, bool is_last) : length(bytes.size()) {
    checksum = adler32_z(adler32_z(0, nullptr, 0), bytes.data(), bytes.size());
    z_stream stream{};
    constexpr int bare = -15, memory = 8;  // without header and checksum, which are of the whole
    if (deflateInit2(&stream, level, Z_DEFLATED, bare, memory, Z_FILTERED) != Z_OK) throw std::bad_alloc();
    constexpr std::size_t mark_of_end = 16;
    packed.resize(deflateBound(&stream, static_cast<uLong>(bytes.size())) + mark_of_end);
    stream.next_in = const_cast<Bytef*>(bytes.data());
    stream.avail_in = static_cast<uInt>(bytes.size());
    stream.next_out = reinterpret_cast<Bytef*>(packed.data());
    stream.avail_out = static_cast<uInt>(packed.size());
    deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH);
    packed.resize(stream.total_out);
    deflateEnd(&stream);
  }
};

class PngWriter final : public RowWriter {
 public:
  PngWriter(std::ostream& out, const WrittenImage& image)
      : out_(out), display_(image.display), threads_(image.threads) {
    rows_.pixel = image.display.bits16 ? 6 : 3;
    rows_.count = rows_.pixel * static_cast<std::size_t>(image.width);
    rows_.bytes.resize(rows_.stride());
    rows_of_piece_ = (bytes_of_piece + rows_.count - 1) / rows_.count;
    out << "\x89PNG\r\n\x1a\n";
    constexpr char rgb = 2, deflated = 0, adaptive = 0, not_interlaced = 0;
    write_chunk(
        out, "IHDR",
        big_endian(static_cast<std::uint32_t>(image.width)) +
            big_endian(static_cast<std::uint32_t>(image.height)) +
            std::string{image.display.bits16 ? '\x10' : '\x08', rgb, deflated, adaptive, not_interlaced});
    for (const auto& [key, value] : image.metadata) write_text(out, key, value);
  }

  void add(const Image& rows) override {
    const std::size_t first = rows_.number();
    rows_.bytes.resize(rows_.bytes.size() + static_cast<std::size_t>(rows.height) * rows_.stride());
    const int threads = threads_for(rows_.number());
#pragma omp parallel for schedule(static) num_threads(threads)
    for (int y = 0; y < rows.height; ++y) {
      const std::vector<unsigned char> row = quantised(row_of(rows, y), display_);
      std::copy(row.begin(), row.end(), rows_.row(first + static_cast<std::size_t>(y)));
    }
    write_rows(rows_.number() / rows_of_piece_ * rows_of_piece_, false);
  }
  void finish() override {
    write_rows(rows_.number(), true);
    write_chunk(out_, "IEND", "");
  }

 private:
  int threads_for(std::size_t rows) const { return rows > rows_of_piece_ ? threads_ : 1; }

  /// The first `end` of the rows that wait, and the end of the image after its last.
  void write_rows(std::size_t end, bool last) {
    const int least = last ? 1 : 0,
              number = std::max(static_cast<int>((end + rows_of_piece_ - 1) / rows_of_piece_), least);
    std::vector<Piece> pieces(static_cast<std::size_t>(number));
    const int threads = threads_for(end);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (int i = 0; i < number; ++i) {
      const std::size_t begin = static_cast<std::size_t>(i) * rows_of_piece_;
      pieces[static_cast<std::size_t>(i)] =
          Piece(rows_.filtered(begin, std::min(begin + rows_of_piece_, end)), last && i + 1 == number);
    }
    for (const Piece& piece : pieces) write(piece, last && &piece == &pieces.back());
    rows_.bytes.erase(rows_.bytes.begin(),
                      rows_.bytes.begin() + static_cast<std::ptrdiff_t>(end * rows_.stride()));
  }

  void write(const Piece& piece, bool last) {
    constexpr char header[] = {'\x78', '\x01'};  // of zlib: deflated, by its fastest levels
    const std::string begin = begun_ ? std::string() : std::string(header, sizeof header);
    begun_ = true;
    checksum_ = adler32_combine(checksum_, piece.checksum, static_cast<z_off_t>(piece.length));
    write_chunk(
        out_, "IDAT",
        begin + piece.packed + (last ? big_endian(static_cast<std::uint32_t>(checksum_)) : std::string()));
  }

  std::ostream& out_;
  const Display& display_;
  int threads_;
  Rows rows_;  ///< those that are not yet written, and the last that is
  std::size_t rows_of_piece_ = 1;
  uLong checksum_ = adler32_z(0, nullptr, 0);
  bool begun_ = false;
};

}  // namespace

std::unique_ptr<RowWriter> write_png(std::ostream& out, const WrittenImage& image) {
  return std::make_unique<PngWriter>(out, image);
}

}  // namespace castray
