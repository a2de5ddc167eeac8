#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

#include "castray/error.h"

void fuzz_one(std::string_view input);

/// Defines what is fed with random input. It may refuse it by InputError, and by nothing else.
#define FUZZ(input)                                                                   \
  extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) { \
    try {                                                                             \
      fuzz_one({reinterpret_cast<const char*>(data), size});                          \
    } catch (const castray::InputError&) {                                            \
    }                                                                                 \
    return 0;                                                                         \
  }                                                                                   \
  void fuzz_one(std::string_view input)
