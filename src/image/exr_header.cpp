#include <cstring>
#include <iterator>

#include "castray/error.h"
#include "image/formats.h"

namespace castray {

namespace {

/// A cursor over bytes that must not end. Throws InputError where they do.
class Walk {
 public:
  explicit Walk(std::string_view bytes) : bytes_(bytes) {}

  std::string_view take(std::size_t count) {
    if (bytes_.size() < count) throw InputError("it is truncated");
    const std::string_view taken = bytes_.substr(0, count);
    bytes_.remove_prefix(count);
    return taken;
  }
  std::uint32_t take_uint32() {
    std::uint32_t value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  /// Up to a zero byte, which is taken off too.
  std::string_view take_text() {
    const std::size_t end = bytes_.find('\0');
    if (end == std::string_view::npos) throw InputError("it is truncated");
    return take(end + 1).substr(0, end);
  }
  bool at_end() const { return bytes_.empty(); }
  bool at_zero() const { return at_end() || bytes_.front() == '\0'; }

 private:
  std::string_view bytes_;
};

struct FixedSize {
  std::string_view type;
  std::size_t size;
};
constexpr FixedSize fixed_sizes[] = {{"box2i", 16},      {"box2f", 16},   {"chromaticities", 32},
                                     {"compression", 1}, {"double", 8},   {"envmap", 1},
                                     {"float", 4},       {"int", 4},      {"keycode", 28},
                                     {"lineOrder", 1},   {"m33f", 36},    {"m44f", 64},
                                     {"m33d", 72},       {"m44d", 128},   {"rational", 8},
                                     {"tiledesc", 9},    {"timecode", 8}, {"v2i", 8},
                                     {"v2f", 8},         {"v2d", 16},     {"v3i", 12},
                                     {"v3f", 12},        {"v3d", 24},     {"deepImageState", 1}};

/// Whether a value of this type may be this long.
bool is_consistent(std::string_view type, std::string_view value) {
  for (const FixedSize& fixed : fixed_sizes)
    if (type == fixed.type) return value.size() == fixed.size;
  Walk walk(value);
  if (type == "chlist") {
    constexpr std::size_t channel_size = 16;
    while (!walk.take_text().empty()) walk.take(channel_size);
    return walk.at_end();
  }
  if (type == "preview") {
    const std::uint64_t width = walk.take_uint32(), height = walk.take_uint32();
    return value.size() == 8 + 4 * width * height;
  }
  if (type == "stringvector")
    while (!walk.at_end()) walk.take(walk.take_uint32());
  return type != "floatvector" || value.size() % sizeof(float) == 0;
}

void check_data_window(const std::string& name, std::string_view value, std::size_t file_length) {
  std::int32_t corners[4];
  std::memcpy(corners, value.data(), sizeof corners);
  check_image_size(name, double(corners[2]) - corners[0] + 1, double(corners[3]) - corners[1] + 1,
                   file_length, exr_pixels_per_byte);
}

void check_header(Walk& walk, const std::string& name, std::size_t file_length) {
  for (;;) {
    const std::string_view attribute = walk.take_text();
    if (attribute.empty()) return;
    const std::string_view type = walk.take_text();
    const std::string_view value = walk.take(walk.take_uint32());
    if (!is_consistent(type, value)) throw InputError("it is corrupt: an attribute has the wrong length");
    if (attribute == "dataWindow" && type == "box2i") check_data_window(name, value, file_length);
  }
}

}  // namespace

void check_exr_headers(const std::string& name, std::string_view bytes) {
  constexpr std::size_t magic_and_version = 8;
  Walk walk(bytes);
  const bool has_parts = (static_cast<unsigned char>(walk.take(magic_and_version)[5]) & 0x10) != 0;
  do {
    check_header(walk, name, bytes.size());
  } while (has_parts && !walk.at_zero());
}

}  // namespace castray
