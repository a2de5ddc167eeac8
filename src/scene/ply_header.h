#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/warning_list.h"

namespace castray {

/// A type of PLY's numbers, in the order of their names in the format.
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };
std::size_t size_of(PlyType type);

struct PlyProperty {
  std::string name;
  PlyType type;
  std::optional<PlyType> count{};  ///< of a list: the type of its length
};

struct PlyElement {
  std::string name;
  std::uint64_t count;
  std::vector<PlyProperty> properties{};
};

enum class PlyEncoding : std::uint8_t { ascii, little_endian, big_endian };

/// The head of a PLY file (Turk 1994): what the rest of it holds, in this order.
struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::ascii;
  std::vector<PlyElement> elements;
  std::size_t size = 0;  ///< in bytes; the rest begins there
  int lines = 0;
  std::optional<std::string> texture;  ///< of MeshLab's "comment TextureFile NAME"
};

/// Warns of lines that are none of the format's. Throws InputError with file and line of what is broken.
PlyHeader read_ply_header(std::string_view text, const std::filesystem::path& file, WarningList& warnings);

}  // namespace castray
