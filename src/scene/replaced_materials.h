#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/warning_list.h"

namespace castray {

/// Materials of the scene that stand in place of those of a mesh's file, by their names there.
class ReplacedMaterials {
 public:
  /// `place`: where the scene file names it.
  void add(const std::string& name, std::uint16_t material, const SourcePlace& place) {
    materials_[name] = {material, place};
  }
  bool empty() const { return materials_.empty(); }
  std::optional<std::uint16_t> find(const std::string& name) const;

  /// Warns of names that are none of `known`, those of the mesh; "" is what has no name.
  void warn_of_unknown(const std::vector<std::string_view>& known, WarningList& warnings) const;

 private:
  struct Replacement {
    std::uint16_t material = 0;
    SourcePlace place;
  };
  std::map<std::string, Replacement> materials_;
};

}  // namespace castray
