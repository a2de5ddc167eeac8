#include <catch2/catch.hpp>

#include <algorithm>
#include <iterator>

#include "stress_checks.h"

using namespace castray;

namespace {

/// Every tree of this processor, and the list if it is short.
std::vector<std::unique_ptr<Tracer>> all_tracers(const MeshView& mesh) {
  std::vector<std::unique_ptr<Tracer>> tracers;
  const auto kernels = available_kernels();
  for (const KernelApi* kernel : kernels) tracers.push_back(make_tracer("wide", mesh, *kernel));
  tracers.push_back(make_tracer("bvh2", mesh, *kernels[0]));
  if (mesh.count < 1000) tracers.push_back(make_tracer("list", mesh, *kernels[0]));
  for (const auto& tracer : tracers) tracer->build(1);
  return tracers;
}

/// The kernels' flat lists, which do not tell the triangle, if the mesh is one for them.
std::vector<std::unique_ptr<Tracer>> facet_tracers(const MeshView& mesh) {
  std::vector<std::unique_ptr<Tracer>> tracers;
  if (mesh.count > 64) return tracers;
  for (const KernelApi* kernel : available_kernels()) {
    tracers.push_back(make_tracer("facets", mesh, *kernel));
    tracers.back()->build(1);
  }
  return tracers;
}

void check_closed(const ClosedShape& closed, double scale, double offset, std::size_t rays) {
  const FloatMesh mesh = place(closed.shape, scale, offset);
  const auto at_seams = rays_at_seams<float>(closed, mesh, scale, offset, rays, 5);
  auto tracers = all_tracers(mesh.view());
  std::ranges::move(facet_tracers(mesh.view()), std::back_inserter(tracers));
  for (const auto& tracer : tracers) {
    INFO(closed.name << ", " << tracer->name() << ", scale " << scale << ", offset " << offset);
    CHECK(count_leaks(*tracer, at_seams) == 0);
  }
  const auto in_double = rays_at_seams<double>(closed, mesh, scale, offset, rays / 4, 6);
  CHECK(count_leaks(Bvh::build(mesh.view(), 1), in_double) == 0);
}

void check_all_closed(std::size_t rays) {
  const std::vector<ClosedShape> shapes = {closed_icosphere(1),        closed_sliver_sphere(10, 3),
                                           closed_icosphere(5),        closed_icosphere(24),
                                           closed_torus_knot(200, 12), closed_sliver_sphere(50, 30)};
  for (const ClosedShape& closed : shapes) {
    for (const double scale : {1e-6, 1.0, 1e6}) check_closed(closed, scale, 0, rays);
    for (const double offset : {1e2, 1e4}) check_closed(closed, 1, offset, rays);
    if (closed.name != "torus knot") check_closed(closed, 1, 1e6, rays);
  }
}

}  // namespace

TEST_CASE("no ray leaves a closed mesh") { check_all_closed(2000); }

TEST_CASE("no ray leaves a closed mesh, millions of rays", "[long]") { check_all_closed(400000); }

TEST_CASE("odd rays hit what the list says, on every kernel") {
  const FloatMesh mesh = place(icosphere(1));
  std::vector<Ray<float>> rays = odd_rays();
  for (std::size_t i = 0; i < rays.size() / 16; ++i) rays[i] = rays[16 * i + i % 16];
  rays.resize(rays.size() / 16);
  const auto tracers = all_tracers(mesh.view());
  for (const auto& tracer : tracers) {
    INFO(tracer->name());
    CHECK(count_disagreements(*tracer, *tracers.back(), rays) == 0);
  }
}
