#pragma once

#include <string>
#include <vector>

#include "scene/line_reader.h"
#include "scene/scene_builder.h"

namespace castray {

/// "map_Kd -s 2 2 -o 0.5 wood grain.png": options, then a file name that may contain spaces.
struct TextureStatement {
  std::string file;
  TextureMap map;                            ///< of -s and -o; the texture is still to be read
  std::vector<std::string> ignored_options;  ///< the others
};

/// Reads what follows "map_Kd" on the line. Throws InputError where no file name is left.
TextureStatement read_texture_statement(LineReader& line);

}  // namespace castray
