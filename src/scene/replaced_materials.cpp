#include "scene/replaced_materials.h"

#include <fmt/core.h>

#include <algorithm>

#include "core/nearest.h"
#include "core/text.h"

namespace castray {

std::optional<std::uint16_t> ReplacedMaterials::find(const std::string& name) const {
  const auto found = materials_.find(name);
  return found == materials_.end() ? std::nullopt : std::optional(found->second.material);
}

void ReplacedMaterials::warn_of_unknown(const std::vector<std::string_view>& known,
                                        WarningList& warnings) const {
  std::vector<std::string_view> named = known;
  std::erase(named, "");
  for (const auto& [name, replacement] : materials_)
    if (std::ranges::find(known, name) == known.end())
      warnings.add(
          replacement.place,
          fmt::format("\"materials\": no triangle of the mesh has a material '{}'{}", printable(name),
                      named.empty() ? "; its file names none" : suggestion(name, named)));
}

}  // namespace castray
