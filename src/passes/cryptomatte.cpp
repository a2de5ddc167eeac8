#include "passes/cryptomatte.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <iterator>
#include <nlohmann/json.hpp>

#include "passes/murmur3.h"

namespace castray {

std::uint32_t matte_id(std::string_view name) {
  const std::uint32_t hash = murmur3_32(name), exponent = hash >> 23 & 255;
  return exponent == 0 || exponent == 255 ? hash ^ (1u << 23) : hash;
}

Cryptomatte::Cryptomatte(std::string layer, const std::vector<std::string>& names, std::size_t pixels)
    : layer_(std::move(layer)), names_(names) {
  std::ranges::transform(names, std::back_inserter(ids_), matte_id);
  for (std::size_t level = 0; level < levels; ++level)
    for (const char channel : {'R', 'G', 'B', 'A'})
      channels_.push_back(
          {fmt::format("{}{:02}.{}", layer_, level, channel), false, std::vector<float>(pixels)});
}

void Cryptomatte::Counts::add(std::size_t thing, std::uint32_t samples) {
  const auto known = std::ranges::find(counts_, thing, &Count::thing);
  if (known != counts_.end())
    known->samples += samples;
  else
    counts_.push_back({thing, samples});
}

void Cryptomatte::set(std::size_t pixel, const Counts& counts, std::uint64_t samples) {
  struct Share {
    std::uint32_t id, samples;
  };
  std::vector<Share> shares;
  for (const Counts::Count& count : counts.counts_) {
    const std::uint32_t id = ids_[count.thing];
    const auto known = std::ranges::find(shares, id, &Share::id);
    if (known != shares.end())
      known->samples += count.samples;
    else
      shares.push_back({id, count.samples});
  }
  std::ranges::sort(shares, [](const Share& a, const Share& b) {
    return a.samples != b.samples ? a.samples > b.samples : a.id < b.id;
  });
  for (std::size_t rank = 0; rank < std::min(shares.size(), ranks); ++rank) {
    channels_[2 * rank].values[pixel] = std::bit_cast<float>(shares[rank].id);
    channels_[2 * rank + 1].values[pixel] =
        static_cast<float>(shares[rank].samples) / static_cast<float>(samples);
  }
}

void Cryptomatte::add_to(Passes& passes) && {
  nlohmann::ordered_json manifest = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < names_.size(); ++i) manifest[names_[i]] = fmt::format("{:08x}", ids_[i]);
  const std::string key = "cryptomatte/" + fmt::format("{:08x}", murmur3_32(layer_)).substr(0, 7) + "/";
  passes.metadata[key + "name"] = layer_;
  passes.metadata[key + "hash"] = "MurmurHash3_32";
  passes.metadata[key + "conversion"] = "uint32_to_float32";
  passes.metadata[key + "manifest"] =
      manifest.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  std::ranges::move(channels_, std::back_inserter(passes.channels));
}

}  // namespace castray
