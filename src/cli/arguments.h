#pragma once

#include <functional>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace castray::cli {

/// One flag or argument, as it was just declared.
class Argument {
 public:
  explicit Argument(CLI::Option& option) : option_(&option) {}
  Argument& required();
  Argument& group(const char* title);  ///< its section of the help
  Argument& hidden();                  ///< left out of the help
  /// Several values may stand in one word, `separator` between them.
  Argument& separated_by(char separator);
  /// Other values are refused.
  Argument& one_of(std::initializer_list<std::string> values);

 private:
  CLI::Option* option_;
};

/// The flags and arguments of one command. A thin cover of CLI11, which costs seconds wherever it is
/// included.
class Arguments {
 public:
  explicit Arguments(CLI::App& app) : app_(app) {}

  /// What the user gives is stored in `value`, which outlives the parsing: a string, path, int, double,
  /// std::uint64_t, optional double, or a vector of these for what may be repeated. `name`: "--long" or
  /// "-s,--long"; `metavar` stands for the value in the help.
  template <class T>
  Argument add(const char* name, T& value, const char* metavar, const char* help);
  /// An argument without a flag, known by its place.
  template <class T>
  Argument add_positional(const char* name, T& value, const char* help);
  /// A flag without a value.
  Argument add_switch(const char* name, bool& value, const char* help);
  /// `take` is called with the last value given; of a switch, where metavar is null, with "on".
  Argument add_text(const std::string& name, const char* metavar, const char* help,
                    std::function<void(const std::string&)> take);
  /// Whether a flag of this name was declared.
  bool has(const std::string& name) const;
  /// What the help ends with.
  void footer(const char* text);

 private:
  CLI::App& app_;
};

}  // namespace castray::cli
