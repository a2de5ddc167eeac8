#include "passes/murmur3.h"

#include <bit>

namespace castray {

namespace {

std::uint32_t scrambled(std::uint32_t word) { return std::rotl(word * 0xcc9e2d51u, 15) * 0x1b873593u; }

/// Up to four bytes, the first one lowest.
std::uint32_t little_endian(std::string_view bytes) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    word |= std::uint32_t{static_cast<unsigned char>(bytes[i])} << (8 * i);
  return word;
}

}  // namespace

std::uint32_t murmur3_32(std::string_view text) {
  std::uint32_t hash = 0;
  std::string_view rest = text;
  for (; rest.size() >= 4; rest.remove_prefix(4))
    hash = std::rotl(hash ^ scrambled(little_endian(rest.substr(0, 4))), 13) * 5 + 0xe6546b64u;
  hash ^= scrambled(little_endian(rest));
  hash ^= static_cast<std::uint32_t>(text.size());
  hash = (hash ^ (hash >> 16)) * 0x85ebca6bu;
  hash = (hash ^ (hash >> 13)) * 0xc2b2ae35u;
  return hash ^ (hash >> 16);
}

}  // namespace castray
