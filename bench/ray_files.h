#pragma once

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <ostream>
#include <string>
#include <vector>

#include "castray/error.h"
#include "core/files.h"
#include "geometry/ray_arrays.h"
#include "scene/transform.h"

namespace castray {

static_assert(std::endian::native == std::endian::little, "the files are little-endian");

/// A file of raw little-endian float32, `group` of them a record.
inline std::vector<float> read_floats(const std::filesystem::path& file, std::size_t group) {
  const std::string bytes = read_file(file);
  if (bytes.size() % (group * sizeof(float)) != 0)
    throw InputError({file.string()},
                     "is not a whole number of records of " + std::to_string(group) + " float32");
  std::vector<float> floats(bytes.size() / sizeof(float));
  std::memcpy(floats.data(), bytes.data(), bytes.size());
  return floats;
}

/// A file of ox oy oz dx dy dz t_max for each ray.
inline RayArrays read_rays(const std::filesystem::path& file) {
  const std::vector<float> n = read_floats(file, 7);
  RayArrays rays;
  for (std::size_t i = 0; i < n.size(); i += 7) {
    rays.add({{n[i], n[i + 1], n[i + 2]}, {n[i + 3], n[i + 4], n[i + 5]}, n[i + 6]});
  }
  return rays;
}

/// A file of 12 numbers for each place of a mesh: the rows of a matrix of three rows and four columns.
inline std::vector<Transform> read_places(const std::filesystem::path& file) {
  const std::vector<float> n = read_floats(file, 12);
  std::vector<Transform> places;
  for (std::size_t i = 0; i < n.size(); i += 12) {
    Transform& place = places.emplace_back();
    for (int row = 0; row < 3; ++row) {
      const float* r = n.data() + i + 4 * static_cast<std::size_t>(row);
      place.rows[row] = {r[0], r[1], r[2]};
      place.translation[row] = r[3];
    }
  }
  return places;
}

/// What a ray hits. With any-hit, t and the triangle are 0 where something is in the way.
struct RayResult {
  float t = std::numeric_limits<float>::infinity();
  std::uint32_t triangle = 0xffffffffu;  ///< none
};

inline RayResult any_result(bool occluded) { return occluded ? RayResult{0, 0} : RayResult{}; }

inline std::size_t count_hits(const std::vector<RayResult>& results) {
  return static_cast<std::size_t>(
      std::count_if(results.begin(), results.end(), [](RayResult r) { return r.triangle != 0xffffffffu; }));
}

inline void write_results(const std::vector<RayResult>& results, const std::filesystem::path& file) {
  write_file(file, [&](std::ostream& out) {
    out.write(reinterpret_cast<const char*>(results.data()),
              static_cast<std::streamsize>(results.size() * sizeof(RayResult)));
  });
}

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace castray
