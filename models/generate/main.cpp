// Writes big meshes, and Cornell boxes with one of them in place of the two boxes, so that nothing big need
// be stored or downloaded.

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <ostream>

#include "cli/tool_main.h"
#include "core/files.h"
#include "generate/forest.h"
#include "generate/leaves.h"

namespace castray {

namespace {

namespace fs = std::filesystem;

bool is_leaves(std::string_view shape) { return shape.ends_with("leaves"); }

/// The material of leaves; where they are squares, FILE_mask.png says what of them is there.
void write_leaf_material(const Shape& shape, const fs::path& obj) {
  std::string text = "newmtl leaf\nKd 0.2 0.45 0.1\n";
  if (!shape.uvs.empty()) {
    const std::string mask = obj.stem().string() + "_mask.png";
    write_image(fs::path(obj).replace_filename(mask), leaf_mask(64), {.tone = {ToneCurve::Kind::linear}});
    text += "map_d -clamp on " + mask + "\n";
  }
  write_file(fs::path(obj).replace_extension(".mtl"), text);
}

void write_obj(const Shape& shape, bool leaves, const std::string& title, const fs::path& file) {
  write_file(file, [&](std::ostream& out) {
    out << "# " << title << '\n';
    if (leaves)
      out << fmt::format("mtllib {}\nusemtl leaf\n",
                         fs::path(file).replace_extension(".mtl").filename().string());
    for (const Vec3d& p : shape.positions) out << fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
    for (const auto& [u, v] : shape.uvs) out << fmt::format("vt {} {}\n", u, v);
    for (const Vec3d& n : shape.normals) out << fmt::format("vn {:.9g} {:.9g} {:.9g}\n", n.x, n.y, n.z);
    const auto corner = [&](std::uint32_t i) {
      std::string text = fmt::format("{}", i + 1);
      if (!shape.uvs.empty()) text += fmt::format("/{}", i + 1);
      if (!shape.normals.empty()) text += fmt::format("{}{}", shape.uvs.empty() ? "//" : "/", i + 1);
      return text;
    };
    for (const Index3& t : shape.triangles)
      out << fmt::format("f {} {} {}\n", corner(t[0]), corner(t[1]), corner(t[2]));
  });
  if (leaves) write_leaf_material(shape, file);
}

/// Nine little-endian floats a triangle, nothing else.
void write_soup(const Shape& shape, const fs::path& file) {
  write_file(file, [&](std::ostream& out) {
    for (const Index3& t : shape.triangles)
      for (std::uint32_t i : t) {
        const Vec3f p(shape.positions[i]);
        const float numbers[3] = {p.x, p.y, p.z};
        char bytes[sizeof numbers];
        std::memcpy(bytes, numbers, sizeof numbers);
        out.write(bytes, sizeof bytes);
      }
  });
}

/// The transform that puts a shape into the box: terrain as its ground, anything else on the floor's middle.
std::string placement(std::string_view shape) {
  return shape == "terrain"
             ? R"([{ "scale": [272, 200, 278] }, { "translate": [275, 100, 280] }])"
             : R"([{ "scale": 180 }, { "rotate": [0, 1, 0, 160] }, { "translate": [278, 182, 280] }])";
}

void write_scene(const std::string& shape, const fs::path& obj, const fs::path& file) {
  const fs::path models =
      fs::relative(fs::path(CASTRAY_ROOT) / "models/cornell_box", fs::absolute(file).parent_path());
  const auto wall = [&](const char* part, const char* material) {
    return fmt::format("    {{ \"obj\": \"{}\", \"material\": \"{}\" }},\n", (models / part).generic_string(),
                       material);
  };
  const std::string text = fmt::format(
      R"(// The Cornell box with a {} instead of its boxes. Made by castray-generate.
{{
  "camera": {{ "position": [278, 273, -800], "look_at": [278, 273, 0], "up": [0, 1, 0], "fov": 40 }},
  "image": {{ "width": 784, "height": 784 }},
  "render": {{ "spp": 64 }},
  "materials": {{
    "white": {{ "type": "diffuse", "kd": [0.725, 0.71, 0.68] }},
    "red": {{ "type": "diffuse", "kd": [0.63, 0.065, 0.05] }},
    "green": {{ "type": "diffuse", "kd": [0.14, 0.45, 0.091] }},
    "light": {{ "type": "diffuse", "kd": [0.65, 0.65, 0.65], "ke": [47.8348, 38.5664, 31.0808] }}
  }},
  "meshes": [
{}    {{ "obj": "{}", {}
      "transform": {} }}
  ]
}}
)",
      shape,
      wall("floor.obj", "white") + wall("left.obj", "red") + wall("right.obj", "green") +
          wall("light.obj", "light"),
      obj.filename().generic_string(), is_leaves(shape) ? "" : "\"material\": \"white\",", placement(shape));
  write_file(file, text);
}

constexpr std::uint32_t kinds_of_trees = 3;

/// Where the trees of one kind are, a matrix a line.
void write_places(const std::vector<TreePlace>& places, std::uint32_t kind, const fs::path& file) {
  write_file(file, [&](std::ostream& out) {
    for (std::size_t i = kind; i < places.size(); i += kinds_of_trees) {
      const TreePlace& tree = places[i];
      const double c = tree.size * std::cos(tree.turn), s = tree.size * std::sin(tree.turn);
      out << fmt::format("{:.6f} 0 {:.6f} {:.4f} 0 {:.6f} 0 {:.4f} {:.6f} 0 {:.6f} {:.4f}\n", c, s,
                         tree.foot.x, tree.size, tree.foot.y, -s, c, tree.foot.z);
    }
  });
}

/// A forest that shows about so many triangles: FILE.json, and beside it the ground, a few trees and where
/// they stand.
std::string write_forest(std::uint32_t triangles, std::uint32_t seed, const fs::path& file) {
  if (file.extension() != ".json") throw InputError({file.string()}, "a forest must end in .json");
  constexpr std::uint32_t most_of_a_tree = 100000, fewest_of_a_tree = 5000;
  const std::uint32_t of_a_tree = std::clamp(triangles / 1000, fewest_of_a_tree, most_of_a_tree);
  const std::uint32_t trees = std::max(triangles / of_a_tree, kinds_of_trees);
  const std::string stem = file.stem().string();
  const auto beside = [&](const std::string& end) { return fs::path(file).replace_filename(stem + end); };
  std::string objects, instances;
  const std::vector<TreePlace> places = make_places(trees, seed);
  for (std::uint32_t kind = 0; kind < kinds_of_trees; ++kind) {
    const Tree tree = make_tree(of_a_tree, seed + kind);
    const std::string name = fmt::format("_tree{}", kind),
                      separator = kind + 1 < kinds_of_trees ? ",\n" : "\n";
    write_obj(tree.wood, false, "wood", beside(name + "_wood.obj"));
    write_obj(tree.leaves, false, "leaves", beside(name + "_leaves.obj"));
    write_places(places, kind, beside(name + ".txt"));
    objects += fmt::format(
        "    \"tree{0}\": [ {{ \"obj\": \"{1}_wood.obj\", \"material\": \"bark\" }},\n"
        "               {{ \"obj\": \"{1}_leaves.obj\", \"material\": \"leaf{0}\" }} ]{2}",
        kind, stem + name, separator);
    instances += fmt::format("    {{ \"object\": \"tree{0}\", \"transforms\": \"{1}.txt\" }}{2}", kind,
                             stem + name, separator);
  }
  write_obj(make_ground(trees), false, "ground", beside("_ground.obj"));
  const double reach = 2.5 * std::sqrt(static_cast<double>(trees));
  write_file(file, fmt::format(R"(// A forest of {} trees of {} triangles. Made by castray-generate.
{{
  "camera": {{ "position": [0, 16, {}], "look_at": [0, 5, 0], "up": [0, 1, 0], "fov": 40 }},
  "image": {{ "width": 960, "height": 540 }},
  "render": {{ "spp": 64 }},
  "environment": {{ "sky": {{ "sun_elevation": 35, "sun_azimuth": 110 }} }},
  "materials": {{
    "ground": {{ "type": "diffuse", "kd": [0.16, 0.13, 0.07] }},
    "bark": {{ "type": "diffuse", "kd": [0.22, 0.16, 0.11] }},
    "leaf0": {{ "type": "diffuse", "kd": [0.13, 0.28, 0.05] }},
    "leaf1": {{ "type": "diffuse", "kd": [0.25, 0.33, 0.06] }},
    "leaf2": {{ "type": "diffuse", "kd": [0.4, 0.24, 0.05] }}
  }},
  "meshes": [ {{ "obj": "{}_ground.obj", "material": "ground" }} ],
  "objects": {{
{}  }},
  "instances": [
{}  ]
}}
)",
                               trees, of_a_tree, reach + 14, stem, objects, instances));
  return fmt::format("forest, {} trees of {} triangles, seed {}", trees, of_a_tree, seed);
}

int run(int argc, char** argv) {
  std::string shape, file;
  std::uint32_t triangles = 0, seed = 1;
  CLI::App app{"Writes a mesh made by rule.", "castray-generate"};
  app.add_option("shape", shape,
                 "icosphere, smooth_icosphere, blob, torus_knot, terrain, hair, soup, sticks, masked_leaves, "
                 "cut_leaves or forest")
      ->required();
  app.add_option("-n,--triangles", triangles, "how many, about (terrain, hair, soup, sticks: exactly)")
      ->required();
  app.add_option("--seed", seed, "another mesh of the kind")->capture_default_str();
  app.add_option(
         "-o", file,
         "FILE.obj; FILE.soup, raw float32, 9 a triangle; or FILE.json, a Cornell box around FILE.obj")
      ->required();
  return tool_main(app, argc, argv, [&] {
    const fs::path target = file;
    if (shape == "forest") {
      fmt::print("{}: {}\n", file, write_forest(triangles, seed, target));
      return 0;
    }
    const fs::path obj = fs::path(target).replace_extension(".obj");
    const Shape made = make_shape(shape, triangles, seed);
    const std::string title = fmt::format("{}, {} triangles, seed {}", shape, made.triangles.size(), seed);
    if (target.extension() == ".soup") {
      write_soup(made, target);
    } else if (target.extension() == ".obj" || target.extension() == ".json") {
      write_obj(made, is_leaves(shape), title, obj);
      if (target.extension() == ".json") write_scene(shape, obj, target);
    } else {
      throw InputError({file}, "must end in .obj, .soup or .json");
    }
    fmt::print("{}: {}\n", file, title);
    return 0;
  });
}

}  // namespace

}  // namespace castray

int main(int argc, char** argv) { return castray::run(argc, argv); }
