#include <catch2/catch.hpp>

#include <algorithm>
#include <vector>

#include "core/sequences.h"

using namespace castray;

// A (t,m,s)-net: 2^m points of s dimensions, of which every elementary interval (a box of sides 2^-d1, 2^-d2,
// ... at multiples of these) of volume 2^(t-m) holds 2^t. A sequence is a (t,s)-sequence if for every m >= t
// all of its blocks of 2^m points, aligned, are such nets. Scrambling changes nothing of that.

namespace {

using Points = std::vector<std::array<float, 4>>;

Points points_of(std::uint32_t key, std::uint32_t block, std::uint64_t first, std::size_t count) {
  Points points;
  for (std::uint64_t i = first; i < first + count; ++i)
    points.push_back(sample_block(SamplerKind::sobol, key, i, block));
  return points;
}

/// Whether each elementary interval of this shape, 2^-digits[i] in dimension dims[i], holds as many points as
/// every other.
bool equidistributed(const Points& points, const std::vector<std::size_t>& dims,
                     const std::vector<int>& digits) {
  int all_digits = 0;
  for (const int d : digits) all_digits += d;
  std::vector<std::size_t> counts(std::size_t{1} << all_digits);
  for (const auto& u : points) {
    std::size_t cell = 0;
    for (std::size_t i = 0; i < dims.size(); ++i)
      cell = cell << digits[i] |
             static_cast<std::size_t>(u[dims[i]] * static_cast<float>(std::size_t{1} << digits[i]));
    ++counts[cell];
  }
  return std::all_of(counts.begin(), counts.end(),
                     [&](std::size_t n) { return n == points.size() / counts.size(); });
}

/// All ways to share `sum` digits out to `parts` dimensions.
std::vector<std::vector<int>> shapes_of(int sum, std::size_t parts) {
  if (parts == 1) return {{sum}};
  std::vector<std::vector<int>> shapes;
  for (int first = 0; first <= sum; ++first)
    for (std::vector<int> rest : shapes_of(sum - first, parts - 1)) {
      rest.insert(rest.begin(), first);
      shapes.push_back(rest);
    }
  return shapes;
}

/// Whether 2^m points are a (t,m,s)-net in these dimensions.
bool is_net(const Points& points, const std::vector<std::size_t>& dims, int t, int m) {
  for (const std::vector<int>& digits : shapes_of(m - t, dims.size()))
    if (!equidistributed(points, dims, digits)) return false;
  return true;
}

/// Whether these dimensions of a block look like a (t,s)-sequence: all prefixes of up to 2^longest points,
/// and the block of as many points at a place further on.
bool is_sequence(std::uint32_t key, std::uint32_t block, const std::vector<std::size_t>& dims, int t,
                 int longest) {
  for (int m = t; m <= longest; ++m)
    for (const std::uint64_t place : {0, 5})
      if (!is_net(points_of(key, block, place << m, std::size_t{1} << m), dims, t, m)) return false;
  return true;
}

struct PointProjection {
  std::vector<std::size_t> dims;
  int t;
};

/// The least t of each projection.
const PointProjection projections[] = {{{0}, 0},    {{1}, 0},    {{2}, 0},    {{3}, 0},    {{0, 1}, 0},
                                       {{0, 2}, 1}, {{1, 2}, 1}, {{0, 3}, 2}, {{1, 3}, 2}, {{2, 3}, 2}};

}  // namespace

TEST_CASE("every elementary interval of a block's dimensions and pairs holds its share of the points") {
  for (const std::uint32_t key : {1u, 77u, 0xdeadbeefu})
    for (const std::uint32_t block : {0u, 3u})
      for (const PointProjection& p : projections) {
        CAPTURE(key, block, p.dims, p.t);
        CHECK(is_sequence(key, block, p.dims, p.t, 11));
        if (p.t > 0) CHECK_FALSE(is_sequence(key, block, p.dims, p.t - 1, 11));
      }
}

TEST_CASE("a block's four dimensions together are a (3,4)-sequence") {
  for (const std::uint32_t key : {1u, 77u}) CHECK(is_sequence(key, 2, {0, 1, 2, 3}, 3, 10));
}

TEST_CASE("independent numbers are not equidistributed") {
  Points points;
  for (std::uint64_t i = 0; i < 256; ++i) points.push_back(sample_block(SamplerKind::independent, 5, i, 1));
  CHECK_FALSE(equidistributed(points, {0}, {8}));
}
