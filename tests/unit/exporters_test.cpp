// One scene as a great many programs would write it: two squares, one textured, of two materials.
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <fstream>
#include <string>
#include <vector>

#include "castray/image.h"
#include "castray/scene.h"
#include "core/sequences.h"
#include "temporary_folder.h"

using namespace castray;

namespace {

/// Draws from the habits of exporters, repeatably.
class Habits {
 public:
  explicit Habits(std::uint32_t seed) : state_(hash32(seed * 2 + 1)) {}

  std::uint32_t below(std::uint32_t n) { return (state_ = hash32(state_ + 0x9e3779b9u)) % n; }
  bool sometimes() { return below(2) == 0; }
  const std::string& one_of(const std::vector<std::string>& choices) {
    return choices[below(static_cast<std::uint32_t>(choices.size()))];
  }

 private:
  std::uint32_t state_;
};

constexpr double corners[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                  {0, 0, 2}, {1, 0, 2}, {1, 1, 2}, {0, 1, 2}};

class Exporter {
 public:
  explicit Exporter(std::uint32_t seed) : habits_(seed) {
    space_ = habits_.one_of({" ", " ", "\t", "  "});
    line_end_ = habits_.one_of({"\n", "\r\n", "\r"});
    const std::string names[][2] = {{"red", "wood"},
                                    {"my red", "my wood"},
                                    {"Material #1", "Material #2"},
                                    {"red.001", "wood.001"},
                                    {"\xc4\x8d"
                                     "erven\xc3\xa1",
                                     "d\xc5\x99"
                                     "evo"},
                                    {"a/red", "b\\wood"},
                                    {"lambert1SG", "initialShadingGroup"}};
    const auto& pair = names[habits_.below(static_cast<std::uint32_t>(std::size(names)))];
    red_ = pair[0], wood_ = pair[1];
  }

  void write(const TemporaryFolder& folder) {
    std::filesystem::create_directories(folder / "mats");
    Image image(2, 2);
    image.pixels = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    for (const char* where : {"Wood Grain.pfm", "mats/Wood Grain.pfm"}) write_image(folder / where, image);
    const std::string library = library_line();
    write_text(folder / "o.obj", obj(library));
    for (const char* where : {"My Scene.mtl", "mats/My Scene.mtl"}) write_text(folder / where, mtl());
  }

 private:
  void write_text(const std::filesystem::path& file, const std::string& lines) {
    std::string text = habits_.sometimes() ? "\xef\xbb\xbf" : "";
    for (const char c : lines) text += c == '\n' ? line_end_ : std::string(1, c);
    std::ofstream(file, std::ios::binary) << text;
  }

  std::string number(double x) {
    switch (habits_.below(5)) {
      case 0:
        return fmt::format("{:.6f}", x);
      case 1:
        return fmt::format("{:e}", x);
      case 2:
        return fmt::format("+{}", x);
      default:
        return fmt::format("{}", x);
    }
  }

  template <class... Words>
  std::string line(const Words&... words) {
    std::string text = habits_.sometimes() ? "" : space_;
    ((text += words + space_), ...);
    if (habits_.below(3) > 0) text.resize(text.size() - space_.size());
    return text + "\n";
  }

  std::string comment() {
    return habits_.one_of(
        {"", "\n", "# exported\n", "#\n\n", "# C:\\files\\\n", "   # indented\n", "#usemtl none\n"});
  }

  std::string library_line() {
    const std::string name =
        habits_.one_of({"My Scene.mtl", "my scene.MTL", "\"My Scene.mtl\"", "My\\ Scene.mtl",
                        "./My Scene.mtl", "mats/My Scene.mtl", "mats\\My Scene.mtl", "MATS\\my scene.mtl",
                        "C:\\Users\\me\\My Scene.mtl", "/home/me/My Scene.mtl", "My Scene.mtl # all of them",
                        "My Scene.mtl My Scene.mtl", "My%20Scene.mtl"});
    return line(std::string("mtllib"), name);
  }

  std::string use(const std::string& name) {
    const std::string written = habits_.one_of({name, name, "\"" + name + "\"", name + " # one"});
    return line(std::string("usemtl"), written);
  }

  std::string index(int i, int count) { return std::to_string(negative_ ? i - count : i + 1); }

  std::string face(const std::vector<int>& at, int first, int normal) {
    std::string text = "f";
    for (const int i : at) {
      text += habits_.below(6) == 0 ? " \\\n" : space_;
      text += index(first + i, 8) + "/" + index(i, 4) + "/" + index(normal, 2);
    }
    return text + (habits_.sometimes() ? " # face\n" : "\n");
  }

  std::string square(int first, int normal) {
    if (habits_.sometimes()) return face({0, 1, 2, 3}, first, normal);
    return face({0, 1, 2}, first, normal) + face({0, 2, 3}, first, normal);
  }

  std::string other() {
    return habits_.one_of({"", "g group\n", "o object name\n", "l -1 -2\n", "p -1\n", "s off\n", "s 1\n",
                           "vp 0.5\n", "cstype bezier\n", "lod 1\n", "g\n"});
  }

  std::string obj(const std::string& library) {
    negative_ = habits_.sometimes();
    std::string text = comment() + library;
    for (const auto& p : corners)
      text += line(std::string("v"), number(p[0]), number(p[1]), number(p[2])) +
              (habits_.below(8) ? "" : comment());
    for (const auto& uv : {std::pair(0, 0), std::pair(1, 0), std::pair(1, 1), std::pair(0, 1)})
      text += habits_.sometimes() ? line(std::string("vt"), number(uv.first), number(uv.second))
                                  : line(std::string("vt"), number(uv.first), number(uv.second), number(0));
    text += line(std::string("vn"), number(0), number(0), number(1)) +
            line(std::string("vn"), number(0), number(0), number(2));
    text += other() + use(red_) + square(0, 0) + comment();
    if (habits_.sometimes()) text += library;
    text += other() + use(wood_) + square(4, 1) + comment();
    if (habits_.sometimes()) text.erase(text.find_last_not_of('\n') + 1);
    return text;
  }

  std::string key(const std::string& name) {
    if (habits_.below(4) > 0) return name;
    std::string lower = name;
    for (char& c : lower) c = static_cast<char>(std::tolower(c));
    return lower;
  }

  std::string mtl() {
    const std::string texture =
        habits_.one_of({"Wood Grain.pfm", "wood grain.PFM", "\"Wood Grain.pfm\"", "Wood\\ Grain.pfm",
                        "D:\\tex\\Wood Grain.pfm", "/tmp/tex/wood grain.pfm",
                        "\\\\server\\share\\Wood Grain.pfm", "./Wood Grain.pfm", "Wood Grain.pfm # image"});
    const std::string options =
        habits_.one_of({"", "-blendu on -blendv on ", "-mm 0 1 ", "-clamp off ", "-texres 512 ", "-boost 2 ",
                        "-cc on ", "-imfchan l ", "-t 0 0 0 "});
    std::string text = comment() + line(std::string("newmtl"), red_);
    text += habits_.sometimes()
                ? line(key("Kd"), number(0.75), number(0.25), number(0.125))
                : line(key("Kd"), number(0.75), number(0.25), number(0.125), std::string("# base"));
    text += extra() + line(std::string("newmtl"), std::string("unused")) + "map_Kd lost.png\n";
    text += line(std::string("newmtl"), wood_) + extra();
    text += line(key("map_Kd"), "-s 2 3 " + options + "-o .5 .25 " + texture);
    return text;
  }

  std::string extra() {
    std::string text;
    for (int i = 0; i < 3; ++i)
      text += habits_.one_of({"", "Ka 0 0 0\n", "illum 2\n", "Ns 96.078431\n", "Ni 1.5\n", "d 1\n", "Tr 0\n",
                              "Ks 0 0 0\n", "Ke 0 0 0\n", "sharpness 60\n", "Tf 1 1 1\n", "Xyz 1 2 3\n",
                              "map_Ka lost.png\n", "Ps 0\n", "aniso 0\n"});
    return text;
  }

  Habits habits_;
  std::string space_, line_end_, red_, wood_;
  bool negative_ = false;
};

}  // namespace

TEST_CASE("a scene is read alike however it is written") {
  for (std::uint32_t seed = 0; seed < 512; ++seed) {
    INFO("variant " << seed);
    const TemporaryFolder folder;
    Exporter(seed).write(folder);
    const Scene scene = load_scene(folder / "o.obj");
    for (const SceneWarning& warning : scene.warnings) {
      INFO(warning.text());
      CHECK(warning.harmless);
    }
    REQUIRE(scene.triangles.size() == 4);
    bool same = true;
    constexpr int order[] = {0, 1, 2, 0, 2, 3};
    for (std::uint32_t t = 0; t < 4; ++t)
      for (std::size_t i = 0; i < 3; ++i) {
        const int corner = order[3 * (t % 2) + i];
        const auto& p = corners[4 * (t / 2) + static_cast<std::uint32_t>(corner)];
        same &= scene.to_world(Vec3d(scene.positions[scene.triangles[t][i]])) == Vec3d{p[0], p[1], p[2]};
        same &= scene.normals[scene.triangle_normals[t][i]] == Vec3f{0, 0, 1};
        same &= scene.uvs[scene.triangle_uvs[t][i]] ==
                std::array<float, 2>{static_cast<float>(corners[corner][0]),
                                     static_cast<float>(corners[corner][1])};
      }
    CHECK(same);
    CHECK(scene.material_of(0).kd == Vec3d{0.75, 0.25, 0.125});
    CHECK(scene.material_of(1).name == scene.material_of(0).name);
    const Material& wood = scene.material_of(2);
    CHECK(wood.kd == Vec3d{1, 1, 1});
    const TextureMap& map = wood.map(SurfaceParameter::kd);
    REQUIRE(map.used());
    CHECK(map.scale == std::array<float, 2>{2, 3});
    CHECK(map.offset == std::array<float, 2>{0.5f, 0.25f});
    CHECK(scene.materials.size() == 2);
    CHECK(scene.textures.size() == 1);
  }
}
