#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace castray::cli {

/// One line that says what is wrong with the command line; an unknown flag or subcommand comes with the
/// nearest known one.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

}  // namespace castray::cli
