#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "castray/image.h"

namespace CLI {
class App;
}

namespace castray::cli {

/// --exposure and --tone, as the user gave them.
struct DisplayFlags {
  double exposure = 0;
  std::string tone;  ///< empty: not given

  void add_to(CLI::App& app);
  bool given() const { return exposure != 0 || !tone.empty(); }
  /// Throws InputError where a value cannot be.
  Display display() const;
};

/// -o FILE, repeatable and required.
void add_outputs(CLI::App& app, std::vector<std::filesystem::path>& files);

/// Says on stderr how many pixels of an image for display are not finite, and what is shown in their place.
void warn_of_nonfinite(const Image& image, const std::filesystem::path& file);

}  // namespace castray::cli
