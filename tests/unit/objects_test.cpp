// Names of the objects that a scene's triangles belong to.
#include <catch2/catch.hpp>

#include <fstream>
#include <string>
#include <vector>

#include "castray/scene.h"
#include "temporary_folder.h"

using namespace castray;
using Names = std::vector<std::string>;

namespace {

const std::string corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\n", face = "f 1 2 3\n", flat = "f 1 2 2\n";

/// Of each triangle.
Names objects_of(const Scene& scene) {
  Names names;
  for (std::uint32_t t = 0; t < scene.triangles.size(); ++t)
    names.push_back(scene.objects[scene.object_of(t)].name);
  return names;
}

Names load_obj(const std::string& statements) {
  const TemporaryFolder folder;
  std::ofstream(folder / "things.obj") << corners + statements;
  return objects_of(load_scene(folder / "things.obj"));
}

}  // namespace

TEST_CASE("an OBJ file's objects have their names, and what is in none has the file's") {
  CHECK(load_obj(face + face) == Names{"things", "things"});
  CHECK(load_obj("o a\n" + face + "o big b\n" + face + face) == Names{"a", "big b", "big b"});
  CHECK(load_obj(face + "o a\n" + face + "o b\no c\n" + face + "o a\n" + face) ==
        Names{"things", "a", "c", "a"});
}

TEST_CASE("groups stand for objects in files without any") {
  CHECK(load_obj("g a\n" + face + "g b\n" + face) == Names{"a", "b"});
  CHECK(load_obj("g x\no a\ng y\n" + face + "g z\n" + face + "o b\n" + face) == Names{"a", "a", "b"});
}

TEST_CASE("triangles that are dropped leave the others to their objects") {
  CHECK(load_obj("o a\n" + flat + face + "o b\n" + flat + "o c\n" + face + flat + face) ==
        Names{"a", "c", "c"});
}

TEST_CASE("meshes of one name are told apart by numbers") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << corners + face;
  std::ofstream(folder / "u.obj") << corners + "o t\n" + face + "o v\n" + face + "o t\n" + face;
  std::ofstream(folder / "s.json") << R"({"meshes": [{"obj": "t.obj"}, {"obj": "t.obj"}, {"obj": "u.obj"}]})";
  CHECK(objects_of(load_scene(folder / "s.json")) == Names{"t", "t.001", "t.002", "v", "t.002"});
}

TEST_CASE("each instance is an object of its own") {
  const TemporaryFolder folder;
  std::ofstream(folder / "t.obj") << corners + face;
  std::ofstream(folder / "s.json") << R"({
    "objects": {"leaf": [{"obj": "t.obj"}]},
    "instances": [{"object": "leaf"}, {"object": "leaf", "transform": [{"translate": [0, 0, 1]}]}]})";
  CHECK(objects_of(load_scene(folder / "s.json")) == Names{"t", "t.001"});
}
