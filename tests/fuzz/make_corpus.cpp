// Writes the inputs that fuzzing starts from: FOLDER/<target>/<seed>.

#include <stb/stb_image_write.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>

#include "castray/film.h"
#include "castray/image.h"
#include "core/files.h"
#include "gltf_file.h"
#include "image/formats.h"
#include "small_files.h"
#include "temporary_folder.h"

namespace {

namespace fs = std::filesystem;
using namespace castray;

void write_seed(const fs::path& folder, const std::string& name, const std::string& content) {
  fs::create_directories(folder);
  write_file(folder / name, content);
}

void copy_files(const fs::path& from, const std::string& suffix, const fs::path& to) {
  fs::create_directories(to);
  for (const auto& entry : fs::recursive_directory_iterator(from))
    if (entry.path().extension() == suffix && entry.file_size() < 4096)
      fs::copy_file(entry.path(), to / entry.path().filename(), fs::copy_options::overwrite_existing);
}

Image small_image() {
  Image image(9, 3);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = Vec3f(static_cast<float>(i) * 0.05f, 0.5f, i % 3 == 0 ? 1.f : 0.f);
  return image;
}

/// In the order in which the image target chooses.
void write_images(const fs::path& folder) {
  const TemporaryFolder made;
  char choice = 0;
  for (const std::string suffix : {".ppm", ".pfm", ".png", ".hdr", ".exr"}) {
    const fs::path file = made / ("image" + suffix);
    write_image(file, small_image(), {}, {{"scene", "s"}, {"spp", "4"}});
    write_seed(folder, suffix.substr(1), choice + read_file(file));
    ++choice;
  }
  const std::vector<unsigned char> pixels(3 * 9 * 9, 100);
  const auto add = [&](const char* name, auto write) {
    std::string bytes(1, choice++);
    write(
        [](void* to, void* from, int size) {
          static_cast<std::string*>(to)->append(static_cast<char*>(from), static_cast<std::size_t>(size));
        },
        &bytes);
    write_seed(folder, name, bytes);
  };
  add("jpg", [&](auto append, void* to) { stbi_write_jpg_to_func(append, to, 9, 9, 3, pixels.data(), 50); });
  add("tga", [&](auto append, void* to) { stbi_write_tga_to_func(append, to, 9, 9, 3, pixels.data()); });
  add("bmp", [&](auto append, void* to) { stbi_write_bmp_to_func(append, to, 9, 9, 3, pixels.data()); });
  const std::string palette(12, '\x50');
  write_seed(folder, "gif", choice++ + gif_file(3, 2, palette, 1, {std::string("\0\1\2\3\1\1", 6)}));
  write_seed(folder, "psd", choice++ + psd_file(2, 1, 3, 8, "abcdef"));
  for (const char* name : {"layer.exr", "autocrop.exr"})
    write_seed(folder, name, '\4' + read_file(fs::path(CASTRAY_ROOT) / "tests/golden/images" / name));
  write_seed(folder, "exposure",
             '\3' + read_file(fs::path(CASTRAY_ROOT) / "tests/golden/images/exposure.hdr"));
  write_seed(folder, "ppm_text", std::string(1, '\0') + "P3\n# grey\n2 1 255\n0 0 0 255 255 255\n");
}

void write_films(const fs::path& folder) {
  Film film(Window{4, 4, 1, 1, 3, 3}, 10);
  for (int y = 1; y < 3; ++y)
    for (int x = 1; x < 3; ++x) film.add(x, y, {1, 2, 3});
  film.samples = {{0, 1}};
  film.key = "scene s, seed 0";
  const TemporaryFolder made;
  write_film(made / "a.film", film);
  write_seed(folder, "film", read_file(made / "a.film"));
}

void write_scenes(const fs::path& folder) {
  copy_files(fs::path(CASTRAY_ROOT) / "scenes", ".json", folder);
  write_seed(folder, "all",
             R"({ "camera": { "position": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0], "fov": 40 },
"image": { "width": 8, "height": 8 }, "render": { "spp": 4, "jitter": false, "crop": [0, 0, 1, 1] },
"materials": { "a": { "type": "microfacet", "kd": [1, 0, 0], "ks": [0, 1, 0], "roughness": 0.5, "ke": [1, 2, 3] },
 "b": { "type": "dielectric", "ior": 1.5, "alpha": 0, "two_sided_emission": true },
 "c": { "type": "conductor", "reflectance": [1, 1, 1] } },
"meshes": [ { "obj": "t.obj", "material": "a", "normals": "face", "transform": [ { "scale": -2 }, { "scale": [1, 2, 3] },
 { "rotate": [0, 1, 0, 30] }, { "translate": [1, 0, 0] } ] }, { "obj": "t.obj" } ], // twice
"environment": { "radiance": [0, 0, 1] } })");
}

void write_objs(const fs::path& folder) {
  copy_files(fs::path(CASTRAY_ROOT) / "models", ".obj", folder);
  write_seed(
      folder, "all",
      "# all\r\nmtllib a.mtl b.mtl\r\nv 0 0 0\r\nv 1e0 +0 -0.0\nv 1 1 0\nv .5 .5 0\nvt 0.5\nvt 0 1\n"
      "vn 0 0 1\ng x\ns off\no y\nusemtl a\nf 1 2 3 4\nf 1/1 2/2 3/1\nf -1//1 -2//1 \\\n -3//1\nl 1 2\n");
}

void write_plys(const fs::path& folder) {
  const std::string vertices = "property float x\nproperty float y\nproperty float z\nproperty uchar red\n";
  const std::string faces = "property list uchar int vertex_indices\nproperty list uchar float texcoord\n";
  write_seed(folder, "ascii",
             "ply\nformat ascii 1.0\ncomment a\nelement vertex 3\n" + vertices + "element face 1\n" + faces +
                 "end_header\n0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2 6 0 0 1 0 0 1\n");
  for (const std::string order : {"little", "big"})
    write_seed(
        folder, order,
        "ply\r\nformat binary_" + order +
            "_endian 1.0\r\nelement vertex 3\r\nproperty char x\r\nproperty char y\r\nproperty int8 z\r\n"
            "element tristrips 1\r\nproperty list uchar char vertex_indices\r\nend_header\r\n" +
            std::string("\0\0\0\1\0\0\0\1\0\4\0\1\2\0", 14));
}

void write_gltfs(const fs::path& folder) {
  GltfFile file;
  const int texture = file.add_texture(png_file(1, 8, 2, {"abc"}));
  file.add_node(
      {{"mesh", file.add_square(file.add(
                    "materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}}}))},
       {"rotation", {0, 0, 0, 1}}});
  file.add_orthographic(1);
  write_seed(folder, "glb", file.glb());
  write_seed(folder, "gltf", file.gltf());
}

void write_mtls(const fs::path& folder) {
  copy_files(fs::path(CASTRAY_ROOT) / "models", ".mtl", folder);
  write_seed(folder, "all",
             "newmtl a\nKd 1 1 1\nKs .5\nKe 3 2 1\nNs 10\nNi 1.5\nPr 0.5\nPm 1\nillum 7\nd 1\n"
             "map_Kd -s 1 2 3 -o 1 -clamp on -mm 0 1 a b.png\nnewmtl b\nKa 0 0 0\n");
}

void write_arguments(const fs::path& folder) {
  write_seed(
      folder, "render",
      "render\ns.json\n--spp\n64\n--size\n640x480\n--crop=0,0,8,8\n--generic\n-o\na.png\n-o\nb.film\n-q");
  write_seed(folder, "compare", "compare\na.png\nb.pfm\n--max\nrelmse=1e-3\n--json\nc.json");
  write_seed(folder, "merge", "merge\na.film\nb.film\n-o\nc.film");
  write_seed(folder, "convert", "convert\na.pfm\n-o\nb.png\n--exposure=1\n--tone=srgb");
  write_seed(folder, "bench", "bench\na.json\n--spp\n1,4\n--seeds\n2");
  write_seed(folder, "info", "info\ns.json");
  write_seed(folder, "help", "--help");
  write_seed(
      folder, "values",
      "=spp 64\nsize 640x480\nrr 0.5\nmax-depth none\nreuse 8x8:32\ntone gamma:0.6\nseed "
      "18446744073709551615\n"
      "sampler sobol\njitter off\nintegrator reference\nprecision double\nepsilon auto\nlights tree\nmis on\n"
      "fault black-light\nthreads 2\nisa auto\naccel bvh\nbuild fast\ngeneric on\ntime-limit 1e3\n"
      "target-error 0.1\ncheckpoint-every 60\nexposure -1\nprogress lines");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: castray-fuzz-corpus FOLDER\n";
    return 2;
  }
  const fs::path folder = argv[1];
  write_scenes(folder / "scene_json");
  write_objs(folder / "obj");
  write_mtls(folder / "mtl");
  write_plys(folder / "ply");
  write_gltfs(folder / "gltf");
  write_images(folder / "image");
  write_films(folder / "film");
  write_arguments(folder / "arguments");
}
