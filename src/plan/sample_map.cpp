#include "plan/sample_map.h"

#include <algorithm>

namespace castray {

namespace {

int blocks_between(int begin, int end) {
  return (end - 1) / SampleMap::block_side - begin / SampleMap::block_side + 1;
}

std::uint64_t area(int width, int height) {
  return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
}

}  // namespace

SampleMap::SampleMap(const Window& window, const SampleRange& samples)
    : window_(window),
      columns_(blocks_between(window.x0, window.x1)),
      first_(samples.first),
      most_(samples.count),
      counts_(static_cast<std::size_t>(columns_ * blocks_between(window.y0, window.y1)), samples.count) {}

Window SampleMap::block(std::size_t i) const {
  const int x = (window_.x0 / block_side + static_cast<int>(i) % columns_) * block_side;
  const int y = (window_.y0 / block_side + static_cast<int>(i) / columns_) * block_side;
  Window w = window_;
  w.x0 = std::max(w.x0, x), w.x1 = std::min(w.x1, x + block_side);
  w.y0 = std::max(w.y0, y), w.y1 = std::min(w.y1, y + block_side);
  return w;
}

void SampleMap::set_counts(std::vector<std::uint64_t> counts) {
  counts_ = std::move(counts);
  most_ = *std::max_element(counts_.begin(), counts_.end());
  uniform_ = std::all_of(counts_.begin(), counts_.end(), [&](std::uint64_t n) { return n == most_; });
}

std::uint64_t SampleMap::total() const { return total(window_.y0, window_.y1, range()); }

std::uint64_t SampleMap::total(int y0, int y1, const SampleRange& samples) const {
  if (y1 <= y0) return 0;
  const std::uint64_t skipped = samples.first - first_;
  const auto row_of = [&](int y) { return y / block_side - window_.y0 / block_side; };
  std::uint64_t sum = 0;
  for (int i = row_of(y0) * columns_; i < (row_of(y1 - 1) + 1) * columns_; ++i) {
    const auto b = static_cast<std::size_t>(i);
    const Window w = block(b);
    const int rows = std::min(y1, w.y1) - std::max(y0, w.y0);
    if (counts_[b] > skipped) sum += area(w.width(), rows) * std::min(counts_[b] - skipped, samples.count);
  }
  return sum;
}

bool SampleMap::wants_any(int x0, int y0, int x1, int y1, std::uint64_t sample) const {
  if (uniform_) return true;
  x0 = std::max(x0, window_.x0), x1 = std::min(x1, window_.x1);
  y0 = std::max(y0, window_.y0), y1 = std::min(y1, window_.y1);
  for (int y = y0; y < y1; y = (y / block_side + 1) * block_side)
    for (int x = x0; x < x1; x = (x / block_side + 1) * block_side)
      if (wants(x, y, sample)) return true;
  return false;
}

}  // namespace castray
