#pragma once

#include <string>

namespace castray::cli {

/// `text` as one word of a shell command.
std::string shell_word(const std::string& text);

}  // namespace castray::cli
