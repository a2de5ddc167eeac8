#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "castray/scene.h"

namespace castray {

enum class Harm : unsigned char { none, changes_picture };

/// Gathers the warnings of a scene's files: the same of the same file is kept once and counted.
class WarningList {
 public:
  void add(const SourcePlace& place, const std::string& message, Harm harm = Harm::changes_picture,
           std::uint64_t count = 1);

  /// All so far, in the order in which they were met; where there were too many to keep, the last says so.
  std::vector<SceneWarning> take();

 private:
  static constexpr std::size_t most = 1000;

  std::vector<SceneWarning> warnings_;
  std::map<std::pair<std::string, std::string>, std::size_t> indices_;  ///< by file and message
  std::uint64_t not_kept_ = 0;
};

}  // namespace castray
