#pragma once

#include <cstdint>
#include <string_view>

namespace castray {

/// MurmurHash3_x86_32 with seed 0 (Appleby 2011).
std::uint32_t murmur3_32(std::string_view text);

}  // namespace castray
