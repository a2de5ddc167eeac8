#pragma once

#include <string>
#include <vector>

namespace castray::test {

/// The arguments of a render that would take hours: of the Cornell box, in 64x64 pixels.
inline std::vector<std::string> endless_render(const std::vector<std::string>& more) {
  std::vector<std::string> arguments{
      "render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "64x64", "--spp", "4000000000"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace castray::test
