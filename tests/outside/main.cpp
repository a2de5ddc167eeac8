#include <castray/film.h>
#include <castray/render.h>
#include <castray/scene.h>

/// Renders SCENE with 4 samples per pixel to IMAGE.
int main(int, char** argv) {
  castray::RenderOptions options;
  options.spp = 4;
  castray::write_film(argv[2], castray::render(castray::load_scene(argv[1]), options).film);
}
