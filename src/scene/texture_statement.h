#pragma once

#include <array>
#include <string>
#include <vector>

#include "scene/line_reader.h"

namespace castray {

/// "map_Kd -s 2 2 -o 0.5 wood grain.png": options, then a file name that may contain spaces.
struct TextureStatement {
  std::string key;   ///< the statement, as it is written
  std::string file;  ///< the end of the line
  SourcePlace place;
  std::array<double, 2> scale{1, 1}, offset{0, 0};  ///< (u,v) -> scale * (u,v) + offset
  bool clamp = false;
  double base = 0, gain = 1;                 ///< of -mm
  double bump = 1;                           ///< of -bm
  char channel = 0;                          ///< of -imfchan: r g b m l z, or 0
  std::string color_space;                   ///< of -colorspace
  std::vector<std::string> ignored_options;  ///< the others
};

/// Reads what follows `key` on the line; `file` is empty where no name is left.
TextureStatement read_texture_statement(const std::string& key, LineReader& line);

}  // namespace castray
