#pragma once

#include <string>
#include <vector>

namespace castray::cli {

/// The words of a command line, "castray" left out, in the one form that is parsed. Understood besides it:
///
///     help COMMAND     as COMMAND --help
///     -o=FILE          as -o FILE; so with every flag of one letter
///     -o FILE FILE     as -o FILE -o FILE, as far as the further words cannot be inputs: of render, images;
///     of
///                      merge, images but films; of convert, images that follow its IMAGE
std::vector<std::string> plain_arguments(const std::vector<std::string>& words);

}  // namespace castray::cli
