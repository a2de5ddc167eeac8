#pragma once

#include <stdlib.h>

#include <filesystem>

#include "castray/error.h"

namespace castray::cli {

/// A new, empty folder that lives as long as this object.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "castray-XXXXXX").string();
    if (!mkdtemp(name.data())) throw InputError(name + ": no temporary folder can be made; set TMPDIR");
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace castray::cli
