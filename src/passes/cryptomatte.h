#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "castray/image.h"

namespace castray {

/// The identifier of a name: its MurmurHash3_32, one bit changed where the same bits as a float would be
/// infinite, NaN or subnormal.
std::uint32_t matte_id(std::string_view name);

/// Mattes of named things as Cryptomatte has them (Friedman and Jones 2015; specification 1.2.0): for each
/// pixel the ids of the six things that cover most of it, each with its coverage.
class Cryptomatte {
 public:
  static constexpr std::size_t levels = 3, ranks = 2 * levels;

  /// `layer` is the name of its channels up to the level's number. Things of one name are one.
  Cryptomatte(std::string layer, const std::vector<std::string>& names, std::size_t pixels);

  /// How many of a pixel's samples see each thing.
  class Counts {
   public:
    void add(std::size_t thing, std::uint32_t samples = 1);

   private:
    friend class Cryptomatte;
    struct Count {
      std::size_t thing;
      std::uint32_t samples;
    };
    std::vector<Count> counts_;
  };

  /// Of a pixel, of so many samples in all. Different pixels may be set by different threads.
  void set(std::size_t pixel, const Counts& counts, std::uint64_t samples);

  /// Adds channels LAYER00.R (id), G (coverage), B, A, LAYER01.R, ... and the metadata with the manifest.
  void add_to(Passes& passes) &&;

 private:
  std::string layer_;
  std::vector<std::string> names_;
  std::vector<std::uint32_t> ids_;
  std::vector<ImageChannel> channels_;
};

}  // namespace castray
