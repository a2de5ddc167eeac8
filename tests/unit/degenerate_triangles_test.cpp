// Triangles that no ray can meet: dropped, counted, and told where they are.
#include <catch2/catch.hpp>

#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "castray/scene.h"
#include "gltf_file.h"
#include "scene/mesh.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// A scene made of one file, and its warnings, those that are harmless with "note: " in front.
struct Loaded {
  Loaded(const std::string& name, const std::string& content, const std::string& json = "") {
    const TemporaryFolder folder;
    std::ofstream(folder / name, std::ios::binary) << content;
    std::ofstream(folder / "s.json") << json;
    scene = load_scene(folder / (json.empty() ? name : "s.json"));
    const std::string prefix = (folder / "").string();
    for (const SceneWarning& warning : scene.warnings) {
      std::string text = warning.text();
      if (text.starts_with(prefix)) text.erase(0, prefix.size());
      told.push_back((warning.harmless ? "note: " : "") + text);
    }
  }

  Scene scene;
  std::vector<std::string> told;
};

using Texts = std::vector<std::string>;

const std::string far =
    "a triangle is left out: a corner is nan, infinite or farther than 1e+100 from the origin";
const std::string flat = "a triangle without area is left out";
const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("a triangle's fault is that of its corners, whatever their scale") {
  const Vec3d a{1, 2, 3}, b{2, 2, 3}, c{1, 3, 4};
  for (const double scale : {1e-300, 1e-160, 1.0, 1e99}) {
    CAPTURE(scale);
    CHECK(fault_of(a * scale, b * scale, c * scale) == std::nullopt);
    CHECK(fault_of(a * scale, b * scale, b * scale) == TriangleFault::no_area);
    CHECK(fault_of(Vec3d{}, a * scale, a * (2 * scale)) == TriangleFault::no_area);
  }
  for (const double x : {not_a_number, inf, -inf, 1.1e100, -1.1e100}) {
    CAPTURE(x);
    CHECK(fault_of({x, 0, 0}, b, c) == TriangleFault::not_finite);
    CHECK(fault_of(a, {0, x, 0}, c) == TriangleFault::not_finite);
    CHECK(fault_of(a, b, {0, 0, x}) == TriangleFault::not_finite);
  }
}

TEST_CASE("OBJ: triangles left out are told with the first corner that is lost, and counted") {
  const Loaded odd("o.obj", three +
                                "v nan 0 0\nv 2 inf 0\nv 0.5 0 0\nv 1e200 0 0\nf 1 2 3\nf 1 2 4\nf 1 5 3\n"
                                "f 1 2 2\nf 1 6 2\nf 1 2 7\n");
  CHECK(odd.scene.triangles.size() == 1);
  CHECK(odd.scene.dropped_triangles == 5);
  CHECK(odd.told == Texts{"o.obj:9:7: " + far + " (3 times)", "note: o.obj:11: " + flat + " (2 times)"});
}

TEST_CASE("OBJ: a vertex that is not finite matters to nobody where no face has it") {
  CHECK(Loaded("o.obj", "v nan 0 0\n" + three + "f 2 3 4\n").told.empty());
}

TEST_CASE("OBJ: of a polygon only what is lost is left out") {
  const Loaded odd("o.obj", three + "v 1 nan 0\nf 1 2 3\nf 1 2 4 3\n");
  CHECK(odd.scene.triangles.size() + odd.scene.dropped_triangles == 3);
  CHECK(odd.told.front().starts_with("o.obj:6:7: " + far));
}

TEST_CASE("PLY: triangles left out are told with their line") {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
      "property float z\nelement face 3\nproperty list uchar int vertex_indices\n"
      "end_header\n";
  const Loaded odd("t.ply", header + "0 0 0\n1 0 0\n0 1 0\nnan 0 0\n3 0 1 2\n3 0 1 1\n3 0 1 3\n");
  CHECK(odd.scene.triangles.size() == 1);
  CHECK(odd.told == Texts{"t.ply:16: " + far, "note: t.ply:15: " + flat});
}

TEST_CASE("glTF: triangles left out are told with their mesh") {
  GltfFile file;
  const int mesh = file.add_mesh(
      {{"attributes",
        {{"POSITION", file.add_accessor<float>({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, inf, 0}})}}},
       {"indices", file.add_indices<std::uint16_t>({0, 1, 2, 0, 1, 3, 2, 2, 2})}});
  file.add_node({{"mesh", mesh}});
  const Loaded odd("t.glb", file.glb());
  CHECK(odd.scene.triangles.size() == 1);
  CHECK(odd.told == Texts{"t.glb: " + far, "note: t.glb: " + flat});
  CHECK(Loaded("t.gltf", file.gltf()).told.front().starts_with("t.gltf:"));
}

TEST_CASE("what transforms move out of reach is told, of meshes and of instances") {
  const std::string away =
      R"("transform": [ { "scale": 1e60 }, { "translate": [1e-200, 0, 0] }, { "scale": 1e60 } ])";
  const std::string near_mesh = R"({ "obj": "o.obj" })", obj = three + "f 1 2 3\n";
  CHECK(Loaded("o.obj", obj, R"({ "meshes": [ )" + near_mesh + R"(, { "obj": "o.obj", )" + away + " } ] }")
            .told == Texts{"o.obj: " + far});
  const std::string objects = R"({ "objects": { "a": [ )" + near_mesh +
                              R"( ] }, "instances": [ { "object": "a" }, )"
                              R"({ "object": "a", )" +
                              away + " } ]";
  CHECK(Loaded("o.obj", obj, objects + "}").told == Texts{"s.json: " + far});
  CHECK_THROWS_WITH(
      Loaded("o.obj", obj, objects + R"(, "instancing": "keep" })"),
      Catch::EndsWith("s.json: an instance reaches farther than 1e+100 from the origin; bring it nearer"));
}
