#include <png.h>
#include <algorithm>
#include <csetjmp>
#include <cstring>
#include <ostream>

#include "castray/error.h"
#include "image/formats.h"
#include "image/row_writer.h"

namespace castray {

namespace {

// libpng reports errors by longjmp, so the functions that call it under setjmp own no objects with
// destructors: all they fill lives with their callers.

struct Failure {
  char message[200] = "unknown error";
};

void on_error(png_structp png, png_const_charp message) {
  auto& failure = *static_cast<Failure*>(png_get_error_ptr(png));
  std::strncpy(failure.message, message, sizeof failure.message - 1);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

struct Source {
  std::string_view bytes;
  std::size_t at = 0;
};

void read_bytes(png_structp png, png_bytep to, std::size_t count) {
  auto& source = *static_cast<Source*>(png_get_io_ptr(png));
  if (source.bytes.size() - source.at < count) png_error(png, "it is truncated");
  std::memcpy(to, source.bytes.data() + source.at, count);
  source.at += count;
}

struct Reader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
};

/// Throws InputError where a chunk claims to be longer than the file: libpng would take the memory first.
void check_chunk_lengths(const std::string& name, std::string_view bytes) {
  constexpr std::size_t signature = 8, around = 12;  // length, type and checksum
  for (std::size_t at = signature; at + around <= bytes.size();) {
    const auto byte = [&](std::size_t i) {
      return static_cast<std::size_t>(static_cast<unsigned char>(bytes[at + i]));
    };
    const std::size_t length = byte(0) << 24 | byte(1) << 16 | byte(2) << 8 | byte(3);
    if (length > bytes.size() - at - around) throw InputError({name}, "is truncated or corrupt");
    at += length + around;
  }
}

bool read_header(const Reader& reader) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);  // palettes, fewer than 8 bits, transparency as alpha
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(const Reader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_image(reader.png, rows);
  png_read_end(reader.png, reader.info);
  return true;
}

/// Pairs of bytes become floats.
void widen(Raster& raster) {
  raster.floats.reserve(raster.bytes.size() / 2);
  for (std::size_t i = 0; i < raster.bytes.size(); i += 2)
    raster.floats.push_back(static_cast<float>(raster.bytes[i] << 8 | raster.bytes[i + 1]) / 65535.f);
  raster.bytes = {};
}

Metadata texts_of(const Reader& reader) {
  png_textp texts = nullptr;
  const int count = png_get_text(reader.png, reader.info, &texts, nullptr);
  Metadata metadata;
  for (int i = 0; i < count; ++i) metadata[texts[i].key] = texts[i].text;
  return metadata;
}

struct Writer {
  png_structp png = nullptr;
  png_infop info = nullptr;
  ~Writer() { png_destroy_write_struct(&png, &info); }
};

void write_bytes(png_structp png, png_bytep from, std::size_t count) {
  static_cast<std::ostream*>(png_get_io_ptr(png))
      ->write(reinterpret_cast<const char*>(from), static_cast<std::streamsize>(count));
}

bool begin_image(const Writer& writer, const WrittenImage& image, const std::vector<png_text>& texts) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(image.width),
               static_cast<png_uint_32>(image.height), image.display.bits16 ? 16 : 8, PNG_COLOR_TYPE_RGB,
               PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_text(writer.png, writer.info, texts.data(), static_cast<int>(texts.size()));
  // noise hardly compresses: zlib's fastest level gives files a few per cent larger in a quarter of the time
  png_set_compression_level(writer.png, 1);
  png_write_info(writer.png, writer.info);
  return true;
}

bool write_row(const Writer& writer, const std::vector<unsigned char>& bytes) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_write_row(writer.png, bytes.data());
  return true;
}

bool end_image(const Writer& writer) {
  if (setjmp(png_jmpbuf(writer.png))) return false;
  png_write_end(writer.png, nullptr);
  return true;
}

bool is_ascii(const std::string& text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c == '\n' || (c >= ' ' && c <= '~'); });
}

/// Latin-1 text is a tEXt chunk, other text an iTXt chunk. libpng takes writable memory, and only reads it.
png_text text_of(const std::string& key, const std::string& value) {
  png_text text{};
  text.compression = is_ascii(value) ? PNG_TEXT_COMPRESSION_NONE : PNG_ITXT_COMPRESSION_NONE;
  text.key = const_cast<char*>(key.c_str());
  text.text = const_cast<char*>(value.c_str());
  text.text_length = value.size();
  return text;
}

}  // namespace

Decoded read_png(const std::string& name, std::string_view bytes) {
  if (!bytes.starts_with("\x89PNG\r\n\x1a\n")) throw InputError({name}, "is not a PNG file");
  check_chunk_lengths(name, bytes);
  Failure failure;
  Source source{bytes};
  Reader reader;
  reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &failure, on_error, on_warning);
  if (reader.png) reader.info = png_create_info_struct(reader.png);
  if (!reader.info) throw std::bad_alloc();
  png_set_read_fn(reader.png, &source, read_bytes);
  const auto fail = [&] {
    throw InputError({name}, std::string("is a corrupt PNG file: ") + failure.message);
  };
  if (!read_header(reader)) fail();

  const std::size_t width = png_get_image_width(reader.png, reader.info);
  const std::size_t height = png_get_image_height(reader.png, reader.info);
  check_image_size(name, static_cast<double>(width), static_cast<double>(height), bytes.size(),
                   8 * 1100);  // one bit a pixel, deflate's best ratio
  const std::size_t row_bytes = png_get_rowbytes(reader.png, reader.info);
  const bool deep = png_get_bit_depth(reader.png, reader.info) == 16;
  Raster raster{static_cast<int>(width),
                static_cast<int>(height),
                png_get_channels(reader.png, reader.info),
                true,
                std::vector<unsigned char>(row_bytes * height),
                {}};
  std::vector<png_bytep> rows(height);
  for (std::size_t y = 0; y < height; ++y) rows[y] = raster.bytes.data() + y * row_bytes;
  if (!read_rows(reader, rows.data())) fail();
  if (deep) widen(raster);
  drop_opaque_alpha(raster);
  return {std::move(raster), texts_of(reader)};
}

namespace {

class PngWriter final : public RowWriter {
 public:
  PngWriter(std::ostream& out, const WrittenImage& image) : display_(image.display) {
    std::vector<png_text> texts;
    for (const auto& [key, value] : image.metadata) texts.push_back(text_of(key, value));
    writer_.png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &failure_, on_error, on_warning);
    if (writer_.png) writer_.info = png_create_info_struct(writer_.png);
    if (!writer_.info) throw std::bad_alloc();
    png_set_write_fn(writer_.png, &out, write_bytes, [](png_structp) {});
    demand(begin_image(writer_, image, texts));
  }
  void add(const Image& rows) override {
    for (int y = 0; y < rows.height; ++y) demand(write_row(writer_, quantised(row_of(rows, y), display_)));
  }
  void finish() override { demand(end_image(writer_)); }

 private:
  void demand(bool good) const {
    if (!good) throw InputError(std::string("PNG: ") + failure_.message);
  }

  const Display& display_;
  Failure failure_;
  Writer writer_;
};

}  // namespace

std::unique_ptr<RowWriter> write_png(std::ostream& out, const WrittenImage& image) {
  return std::make_unique<PngWriter>(out, image);
}

}  // namespace castray
