#include <catch2/catch.hpp>
#include <filesystem>

#include "castray/film.h"
#include "castray/noise_test.h"
#include "castray/render.h"
#include "castray/scene.h"
#include "same_bytes.h"

using namespace castray;

namespace {

const std::string root = CASTRAY_ROOT;

RenderOptions options_of(int side, std::uint64_t seed) {
  RenderOptions options;
  options.width = options.height = side;
  options.spp = 64;
  options.seed = seed;
  options.threads = 1;  // other tests run beside this one
  return options;
}

Film render_film(const Scene& scene, const RenderOptions& options) {
  return render_replicates(scene, options, 16).film;
}

std::vector<std::filesystem::path> scene_files() {
  std::vector<std::filesystem::path> files;
  for (const auto& file : std::filesystem::directory_iterator(root + "/scenes"))
    if (!file.is_directory() && file.path().stem() != "castray.schema") files.push_back(file.path());
  return files;
}

/// As an .exr file holds it.
ImageFile image_file_of(const Film& film) { return {film.image(), false, describe(film), noise_of(film)}; }

}  // namespace

// tests/golden/films was rendered by the reference integrator; each comparison has a false-alarm rate of
// 0.01 %: there are fifty. Other instruction sets have the bytes of the widest one of their arithmetic.
TEST_CASE("every kernel renders every scene as the stored films show it") {
  const std::string isa = GENERATE(from_range(test::arithmetics()));
  const bool generic = GENERATE(false, true);
  const AccelKind accel = GENERATE(AccelKind::automatic, AccelKind::bvh);
  for (const std::filesystem::path& path : scene_files()) {
    const std::string name = path.stem();
    RenderOptions options = options_of(48, 2);
    options.isa = isa;
    options.generic = generic;
    options.accel = accel;
    const Film film = render_film(load_scene(path), options);
    const NoiseTest test =
        test_noise(film, read_film(root + "/tests/golden/films/" + name + ".film"), 0.0001);
    INFO(isa << (generic ? ", generic" : "") << (accel == AccelKind::bvh ? ", tree, " : ", ") << name
             << ": p = " << test.p << ", channel " << test.channel << ", pixels " << test.x0 << "," << test.y0
             << " to " << test.x1 << "," << test.y1 << ": " << test.mean << " against "
             << test.mean_reference);
    CHECK_FALSE(test.differs());
  }
}

TEST_CASE("instruction sets of one arithmetic render every scene to the same bytes") {
  RenderOptions options = options_of(24, 2);
  for (const std::filesystem::path& path : scene_files())
    for (const bool generic : {false, true}) {
      CAPTURE(path, generic);
      options.generic = generic;
      test::check_same_bytes(load_scene(path), options);
    }
}

TEST_CASE("a change of 1 % of one material's kd is caught at 64 spp") {
  Scene scene = load_scene(root + "/scenes/cornell_box.json");
  const Film before = render_film(scene, options_of(128, 1));
  const auto change = [&](const std::string& name) {
    Scene changed = scene;
    for (Material& material : changed.materials)
      if (material.name == name) material.kd *= 1.01;
    return changed;
  };
  for (const char* name : {"white", "red", "green"}) {
    INFO(name);
    const NoiseTest same_seed = test_noise(render_film(change(name), options_of(128, 1)), before, 0.01);
    CHECK(same_seed.paired);
    CHECK(same_seed.differs());
  }
  const Film changed = render_film(change("white"), options_of(128, 2));
  CHECK(test_noise(changed, before, 0.01).differs());
  CHECK(test_noise(image_file_of(changed), image_file_of(before), 0.01).differs());
  const Film unchanged = render_film(scene, options_of(128, 2));
  CHECK_FALSE(test_noise(unchanged, before, 0.01).differs());
  CHECK_FALSE(test_noise(image_file_of(unchanged), image_file_of(before), 0.01).differs());
}

// At alpha = 0.05 at most 50 + 4 sqrt(47.5) = 77 of 1000 pairs of seeds may raise an alarm; none at all would
// show a test without power. The conductor's blocks are the most correlated ones of all scenes.
TEST_CASE("a thousand unchanged seeds raise no more than the stated rate of alarms", "[long]") {
  const std::string name = GENERATE("cornell_box", "cornell_conductor");
  const Scene scene = load_scene(root + "/scenes/" + name + ".json");
  RenderOptions options = options_of(32, 0);
  options.spp = 32;
  int alarms = 0, alarms_of_images = 0;
  for (std::uint64_t pair = 0; pair < 1000; ++pair) {
    options.seed = 2 * pair;
    const Film a = render_replicates(scene, options, 8).film;
    options.seed = 2 * pair + 1;
    const Film b = render_replicates(scene, options, 8).film;
    alarms += test_noise(a, b, 0.05).differs();
    alarms_of_images += test_noise(image_file_of(a), image_file_of(b), 0.05).differs();
  }
  UNSCOPED_INFO(name << ": " << alarms << " alarms of 1000 by films, " << alarms_of_images << " by images");
  CHECK(alarms <= 77);
  CHECK(alarms >= 5);
  CHECK(alarms_of_images <= 77);
  CHECK(alarms_of_images >= 5);
}
