// Attacks the ray/triangle and ray/box arithmetic of every accelerator and instruction set, and tells how
// often it broke. Exits with 1 if it ever did.

#include <fmt/core.h>
#include <omp.h>

#include <algorithm>

#include "cli/tool_main.h"
#include "instanced.h"
#include "stress_checks.h"
#include "wavefront/choose_kernel.h"

namespace castray {
namespace {

/// Prints rows as they come; remembers whether any has failures.
class Table {
 public:
  Table() {
    fmt::print("{:<26} {:<12} {:>7} {:>8} {:>9} {:>7}\n", "test", "kernel", "scale", "offset", "tried",
               "failed");
  }

  void add(const std::string& test, const std::string& kernel, double scale, double offset, std::size_t tried,
           std::size_t failed) {
    fmt::print("{:<26} {:<12} {:>7g} {:>8g} {:>9} {:>7}\n", test, kernel, scale, offset, tried, failed);
    std::fflush(stdout);
    all_failed_ += failed;
  }

  bool is_clean() const { return all_failed_ == 0; }

 private:
  std::size_t all_failed_ = 0;
};

/// bvh2, and wide by every kernel of this processor.
std::vector<std::unique_ptr<Tracer>> make_trees(const MeshView& mesh, int threads) {
  std::vector<std::unique_ptr<Tracer>> trees;
  trees.push_back(make_tracer("bvh2", mesh, choose_kernel("auto")));
  for (const KernelApi* kernel : available_kernels()) trees.push_back(make_tracer("wide", mesh, *kernel));
  for (const auto& tree : trees) tree->build(threads);
  return trees;
}

/// The rays are made and traced a million at a time: they take less memory than the mesh's trees.
void test_leaks(Table& table, const ClosedShape& closed, double scale, double offset, std::size_t count,
                int threads) {
  constexpr std::size_t at_once = 1000000;
  const std::string test = "leaks, " + closed.name;
  const FloatMesh mesh = place(closed.shape, scale, offset);
  const auto trees = make_trees(mesh.view(), threads);
  std::vector<std::size_t> leaks(trees.size());
  for (std::size_t done = 0; done < count; done += at_once) {
    const auto rays = rays_at_seams<float>(closed, mesh, scale, offset, std::min(at_once, count - done),
                                           static_cast<std::uint32_t>(done / at_once));
    for (std::size_t i = 0; i < trees.size(); ++i) leaks[i] += count_leaks(*trees[i], rays);
  }
  for (std::size_t i = 0; i < trees.size(); ++i)
    table.add(test, trees[i]->name(), scale, offset, count, leaks[i]);
  const auto double_rays = rays_at_seams<double>(closed, mesh, scale, offset, count / 10, 2);
  table.add(test, "bvh2 double", scale, offset, double_rays.size(),
            count_leaks(Bvh::build(mesh.view(), threads), double_rays));
}

/// The reference's list, and the kernels' of facets, which scenes of up to 64 triangles get.
void test_leaks_of_lists(Table& table, const ClosedShape& closed, double scale, double offset,
                         std::size_t count) {
  const FloatMesh mesh = place(closed.shape, scale, offset);
  const auto rays = rays_at_seams<float>(closed, mesh, scale, offset, count, 3);
  std::vector<std::unique_ptr<Tracer>> lists;
  lists.push_back(make_tracer("list", mesh.view(), choose_kernel("auto")));
  for (const KernelApi* kernel : available_kernels())
    lists.push_back(make_tracer("facets", mesh.view(), *kernel));
  for (const auto& list : lists) {
    list->build(1);
    table.add("leaks, few, " + closed.name, list->name(), scale, offset, count, count_leaks(*list, rays));
  }
}

/// The mesh as an instance, by transforms of all kinds.
void test_leaks_of_instances(Table& table, const ClosedShape& closed, std::size_t count, int threads) {
  const FloatMesh mesh = place(closed.shape, 0.5);
  const auto rays = rays_at_seams<float>(closed, mesh, 0.5, 0, count, 4);
  for (const Transform& at : kinds_of_places())
    for (const KernelApi* kernel : available_kernels()) {
      const auto tracer = make_instance_tracer(as_instances(scene_of(mesh.view()), {at}), *kernel);
      tracer->build(threads);
      table.add("leaks, " + closed.name, tracer->name(), 0.5, 0, count, count_leaks(*tracer, rays));
    }
}

void test_agreement(Table& table, const std::string& name, const Shape& shape, double scale, double offset,
                    std::size_t count, int threads) {
  const FloatMesh mesh = place(shape, scale, offset);
  const auto trees = make_trees(mesh.view(), threads);
  const auto list = make_tracer("list", mesh.view(), choose_kernel("auto"));
  list->build(threads);
  const auto few = rays_around(mesh, count / 100, 3, scale, offset),
             many = rays_around(mesh, count, 4, scale, offset);
  table.add("same as list, " + name, trees[0]->name(), scale, offset, few.size(),
            count_disagreements(*trees[0], *list, few));
  for (std::size_t i = 1; i < trees.size(); ++i) {
    table.add("same as bvh2, " + name, trees[i]->name(), scale, offset, many.size(),
              count_disagreements(*trees[i], *trees[0], many));
  }
}

void test_odd_rays(Table& table, int threads) {
  const FloatMesh mesh = place(icosphere(2));
  const auto list = make_tracer("list", mesh.view(), choose_kernel("auto"));
  list->build(threads);
  const auto rays = odd_rays();
  for (const auto& tree : make_trees(mesh.view(), threads)) {
    table.add("odd rays as list", tree->name(), 1, 0, rays.size(), count_disagreements(*tree, *list, rays));
  }
}

bool run_all(std::size_t count, int threads) {
  Table table;
  for (const ClosedShape& closed :
       {closed_icosphere(32), closed_torus_knot(600, 16), closed_sliver_sphere(200, 50)}) {
    test_leaks(table, closed, 1, 0, count, threads);
    test_leaks_of_instances(table, closed, count / 10, threads);
    for (const double scale : {1e-6, 1e-4, 1e-2, 1e2, 1e4, 1e6})
      test_leaks(table, closed, scale, 0, count / 10, threads);
    // Beyond, float moves the knot's vertices by more than its tube is wide.
    const std::vector<double> offsets =
        closed.name == "torus knot" ? std::vector<double>{1e2, 1e4} : std::vector<double>{1e2, 1e4, 1e6};
    // At 1e6 boxes grow by a quarter of the shape's radius, and a ray meets thousands of triangles.
    for (const double offset : offsets)
      test_leaks(table, closed, 1, offset, count / (offset < 1e6 ? 10 : 100), threads);
  }
  for (const ClosedShape& closed : {closed_icosphere(1), closed_sliver_sphere(10, 3)}) {
    for (const double scale : {1e-6, 1.0, 1e6}) test_leaks_of_lists(table, closed, scale, 0, count / 10);
    test_leaks_of_lists(table, closed, 1, 1e6, count / 10);
  }
  for (const std::string name : {"blob", "torus_knot", "terrain", "hair", "soup", "sticks"}) {
    const Shape shape = make_shape(name, name == "sticks" ? 2000 : 20000, 1);  // a ray meets many sticks
    for (const double scale : {1e-6, 1.0, 1e6})
      test_agreement(table, name, shape, scale, 0, count / 25, threads);
    test_agreement(table, name, shape, 1, 1e4, count / 25, threads);
  }
  test_odd_rays(table, threads);
  return table.is_clean();
}

int run(int argc, char** argv) {
  std::size_t count = 10000000;
  int threads = 2;
  CLI::App app{"Attacks the numerics of rays; prints what was tried and what failed.", "castray-stress"};
  app.add_option("--rays", count, "of the largest tests; others take a tenth or less")
      ->check(CLI::Range(1000, 1000000000))
      ->capture_default_str();
  app.add_option("--threads", threads, "to build and trace with")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  return tool_main(app, argc, argv, [&] {
    omp_set_num_threads(threads);
    return run_all(count, threads) ? 0 : 1;
  });
}

}  // namespace
}  // namespace castray

int main(int argc, char** argv) { return castray::run(argc, argv); }
