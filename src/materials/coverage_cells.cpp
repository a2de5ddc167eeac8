#include "materials/coverage_cells.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include "geometry/geometry_records.h"
#include "materials/texture.h"

namespace castray {

namespace {

/// All grids together have as many cells as stay in the caches. Cells smaller than those of the greatest side
/// save little; larger ones than those of the least tell nothing.
constexpr std::size_t most_cells = std::size_t{1} << 22;
constexpr std::uint32_t greatest_side = 64, least_side = 8;
constexpr std::size_t most_grids = most_cells / (least_side * least_side);
constexpr std::size_t cells_in_word = 16;

std::size_t words_of(std::uint32_t side) { return std::size_t{side} * side / cells_in_word; }

/// What of a material's image is there, texel by texel.
class CoverageTexels {
 public:
  CoverageTexels(const Scene& scene, const Material& material)
      : map_(material.map(SurfaceParameter::coverage)),
        texture_(scene.textures[static_cast<std::size_t>(map_.texture)]),
        constant_(static_cast<float>(material.coverage)),
        cells_(static_cast<std::size_t>(texture_.width) * static_cast<std::size_t>(texture_.height),
               unknown) {}

  /// Of the points between u and v of the mesh, each from the first to the second.
  CoverageCell between(std::array<double, 2> u, std::array<double, 2> v) {
    const Range x = texels_between(u, 0, texture_.width),
                y = texels_between({v[1], v[0]}, 1, texture_.height);
    constexpr double most_texels = 64;
    // false, too, where a number is not finite
    if (!((x.last - x.first + 1) * (y.last - y.first + 1) <= most_texels)) return cell_mixed;
    const CoverageCell first = at(x.first, y.first);
    for (double row = y.first; row <= y.last; ++row)
      for (double column = x.first; column <= x.last; ++column)
        if (at(column, row) != first) return cell_mixed;
    return first;
  }

 private:
  static constexpr std::uint8_t unknown = 0xff;

  struct Range {
    double first, last;
  };

  /// Those that points between two coordinates may take their values from, beyond the image's border, too.
  Range texels_between(std::array<double, 2> ends, std::size_t axis, int size) const {
    constexpr double rounding = 0x1p-20;
    double place[2], most = 1;
    for (std::size_t i = 0; i < 2; ++i) {
      const double scaled = double{map_.scale[axis]} * ends[i];
      most = std::max(most, std::abs(scaled) + std::abs(double{map_.offset[axis]}));
      const double inside = scaled + double{map_.offset[axis]};
      place[i] = (axis == 0 ? inside : 1 - inside) * size - 0.5;
    }
    const double slack = rounding * most * size;
    Range range{std::floor(std::min(place[0], place[1]) - slack),
                std::floor(std::max(place[0], place[1]) + slack) + 1};
    if (map_.clamp) {
      range.first = std::clamp(range.first, 0.0, double(size - 1));
      range.last = std::clamp(range.last, 0.0, double(size - 1));
    }
    return range;
  }

  CoverageCell at(double column, double row) {
    const auto wrapped = [](double i, int size) {
      return static_cast<std::size_t>(i - std::floor(i / size) * size);
    };
    const std::size_t i = wrapped(row, texture_.height) * static_cast<std::size_t>(texture_.width) +
                          wrapped(column, texture_.width);
    if (cells_[i] == unknown) cells_[i] = static_cast<std::uint8_t>(cell_of(i));
    return static_cast<CoverageCell>(cells_[i]);
  }

  CoverageCell cell_of(std::size_t i) const {
    constexpr float least_there = 1 - 1e-6f;
    const float coverage = constant_ * number_of_texel(texel(texture_, i), map_);
    return coverage >= least_there ? cell_there : coverage <= 0 ? cell_missing : cell_mixed;
  }

  const TextureMap& map_;
  const Texture& texture_;
  float constant_;
  std::vector<std::uint8_t> cells_;
};

/// Texture coordinates of a triangle's corners, and its material.
struct Outline {
  std::uint32_t material;
  std::array<float, 6> uv;

  bool operator==(const Outline& other) const {
    return material == other.material && std::memcmp(&uv, &other.uv, sizeof uv) == 0;
  }
};

struct HashOfOutline {
  std::size_t operator()(const Outline& outline) const {
    std::uint64_t hash = outline.material;
    for (const float coordinate : outline.uv)
      hash = (hash ^ std::bit_cast<std::uint32_t>(coordinate)) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
    return hash;
  }
};

/// From the first to the last of what b1 and b2, each between i / side and (i + 1) / side, make of a corner
/// coordinate.
std::array<double, 2> coordinates_in(const Outline& outline, std::size_t axis, double b1, double b2,
                                     double size) {
  const double at0 = outline.uv[axis], to1 = double{outline.uv[2 + axis]} - at0,
               to2 = double{outline.uv[4 + axis]} - at0;
  const double corner = at0 + b1 * to1 + b2 * to2;
  return {corner + size * (std::min(to1, 0.0) + std::min(to2, 0.0)),
          corner + size * (std::max(to1, 0.0) + std::max(to2, 0.0))};
}

void fill_grid(const Outline& outline, std::uint32_t side, CoverageTexels& texels, std::uint32_t* cells) {
  const double size = 1.0 / side;
  for (std::uint32_t row = 0; row < side; ++row)
    for (std::uint32_t column = 0; column + row < side; ++column) {
      const double b1 = column * size, b2 = row * size;
      const CoverageCell cell =
          texels.between(coordinates_in(outline, 0, b1, b2, size), coordinates_in(outline, 1, b1, b2, size));
      const std::size_t i = std::size_t{row} * side + column;
      cells[i / cells_in_word] |= static_cast<std::uint32_t>(cell) << (2 * (i % cells_in_word));
    }
}

}  // namespace

CoverageCells::CoverageCells(const Scene& scene) {
  const auto has_image = [](const Material& m) {
    return m.map(SurfaceParameter::coverage).used() && !m.is_window();
  };
  if (scene.triangle_uvs.empty() || std::ranges::none_of(scene.materials, has_image)) return;

  std::unordered_map<Outline, std::uint32_t, HashOfOutline> numbers;
  std::vector<Outline> outlines;
  grids_.assign(scene.triangles.size(), no_coverage_grid);
  for (std::size_t i = 0; i < grids_.size(); ++i) {
    const Index3& index = scene.triangle_uvs[i];
    const std::uint32_t material = scene.triangle_material[i];
    if (!has_image(scene.materials[material]) || index[0] == Scene::no_index) continue;
    Outline outline{material, {}};
    for (std::size_t k = 0; k < 6; ++k) outline.uv[k] = static_cast<float>(scene.uvs[index[k / 2]][k % 2]);
    const auto [found, is_new] = numbers.try_emplace(outline, static_cast<std::uint32_t>(outlines.size()));
    if (is_new && outlines.size() == most_grids) {
      numbers.erase(found);
      continue;
    }
    if (is_new) outlines.push_back(outline);
    grids_[i] = found->second;
  }

  side_ = greatest_side;
  while (outlines.size() * side_ * side_ > most_cells) side_ /= 2;
  const std::size_t words = words_of(side_);
  cells_.resize(outlines.size() * words);
  std::unordered_map<std::uint32_t, CoverageTexels> texels;
  for (std::size_t i = 0; i < outlines.size(); ++i) {
    const std::uint32_t material = outlines[i].material;
    auto& of_material = texels.try_emplace(material, scene, scene.materials[material]).first->second;
    fill_grid(outlines[i], side_, of_material, &cells_[i * words]);
  }
  for (std::uint32_t& grid : grids_)
    if (grid != no_coverage_grid) grid *= static_cast<std::uint32_t>(words);
}

}  // namespace castray
