#include "geometry/closed_surface.h"

#include <algorithm>
#include <utility>

namespace castray {
namespace {

/// An edge of a triangle, kept with the lower of its two positions.
struct Edge {
  std::uint32_t other;  ///< the higher position
  std::uint32_t triangle;
  std::int32_t direction;  ///< 1 towards the higher position, -1 towards the lower
};

/// All edges, those with one lower position side by side, sorted by the other.
class EdgeTable {
 public:
  EdgeTable(const MeshView& mesh, int threads) {
    std::uint32_t positions = 0;
    for (std::uint32_t t = 0; t < mesh.count; ++t)
      for (const std::uint32_t v : mesh.triangles[t]) positions = std::max(positions, v + 1);
    first_.resize(std::size_t{positions} + 1);
    for_edges(mesh, [&](std::uint32_t a, std::uint32_t b, std::uint32_t) { ++first_[std::min(a, b)]; });
    std::uint32_t sum = 0;
    for (std::uint32_t& first : first_) sum += std::exchange(first, sum);
    edges_.resize(sum);
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for_edges(mesh, [&](std::uint32_t a, std::uint32_t b, std::uint32_t t) {
      edges_[next[std::min(a, b)]++] = {std::max(a, b), t, a < b ? 1 : -1};
    });
    const auto count = static_cast<std::int64_t>(positions);
#pragma omp parallel for schedule(static) num_threads(threads) if (threads > 1)
    for (std::int64_t v = 0; v < count; ++v)
      std::sort(edges_.begin() + first_[static_cast<std::size_t>(v)],
                edges_.begin() + first_[static_cast<std::size_t>(v) + 1],
                [](const Edge& a, const Edge& b) { return a.other < b.other; });
  }

  /// Calls visit(lower position, edges between it and a higher one, how many these are) where edges of
  /// triangles in `has` are free.
  template <class Visit>
  void for_free(const std::vector<bool>& has, Visit visit) const {
    for (std::uint32_t v = 0; v + 1 < first_.size(); ++v) {
      for (std::uint32_t i = first_[v], end; i < first_[v + 1]; i = end) {
        int up = 0;
        for (end = i; end < first_[v + 1] && edges_[end].other == edges_[i].other; ++end)
          if (has[edges_[end].triangle]) up += edges_[end].direction;
        if (up != 0) visit(v, &edges_[i], end - i);
      }
    }
  }

 private:
  template <class Visit>
  static void for_edges(const MeshView& mesh, Visit visit) {
    for (std::uint32_t t = 0; t < mesh.count; ++t) {
      const Index3& corner = mesh.triangles[t];
      for (std::size_t k = 0; k < 3; ++k)
        if (corner[k] != corner[(k + 1) % 3]) visit(corner[k], corner[(k + 1) % 3], t);
    }
  }

  std::vector<std::uint32_t> first_;
  std::vector<Edge> edges_;
};

}  // namespace

ClosedSurface closed_surface(const MeshView& mesh, int threads) {
  const EdgeTable edges(mesh, threads);
  ClosedSurface surface{std::vector<bool>(mesh.count, true), {}};
  std::vector<bool> left = surface.has;
  edges.for_free(surface.has, [&](std::uint32_t, const Edge* edge, std::uint32_t count) {
    for (std::uint32_t i = 0; i < count; ++i) left[edge[i].triangle] = false;
  });
  surface.has = std::move(left);
  edges.for_free(surface.has, [&](std::uint32_t v, const Edge* edge, std::uint32_t) {
    surface.rim.push_back({v, edge->other, edge->other});
  });
  const auto size = static_cast<std::size_t>(std::ranges::count(surface.has, true));
  if (8 * surface.rim.size() > size) return {std::vector<bool>(mesh.count, false), {}};
  return surface;
}

}  // namespace castray
