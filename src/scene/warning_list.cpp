#include "scene/warning_list.h"

#include <fmt/core.h>

namespace castray {

std::string SceneWarning::text() const {
  return placed(place, count > 1 ? fmt::format("{} ({} times)", message, count) : message);
}

void WarningList::add(const SourcePlace& place, const std::string& message, Harm harm, std::uint64_t count) {
  const auto found = indices_.find({place.file, message});
  if (found != indices_.end()) {
    warnings_[found->second].count += count;
  } else if (warnings_.size() < most) {
    indices_.emplace(std::pair(place.file, message), warnings_.size());
    warnings_.push_back({place, message, harm == Harm::none, count});
  } else {
    not_kept_ += count;
  }
}

std::vector<SceneWarning> WarningList::take() {
  if (not_kept_ > 0) {
    SceneWarning& last = warnings_.emplace_back();
    last.message = fmt::format("{} more warnings are not kept", not_kept_);
    last.harmless = true;
  }
  indices_.clear();
  return std::move(warnings_);
}

}  // namespace castray
