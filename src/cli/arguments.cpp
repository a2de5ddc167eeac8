#include "cli/arguments.h"

#include <algorithm>
#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "core/nearest.h"
#include "core/text.h"

namespace castray::cli {

Argument& Argument::required() {
  option_->required();
  return *this;
}

Argument& Argument::group(const char* title) {
  option_->group(title);
  return *this;
}

Argument& Argument::hidden() { return group(""); }

Argument& Argument::separated_by(char separator) {
  option_->delimiter(separator);
  return *this;
}

Argument& Argument::one_of(std::initializer_list<std::string> values) {
  option_->check([known = std::vector<std::string>(values)](const std::string& text) {
    if (std::find(known.begin(), known.end(), text) != known.end()) return std::string();
    return "'" + printable(text) + "' is none of its values" + suggestion(text, {known.begin(), known.end()});
  });
  return *this;
}

template <class T>
Argument Arguments::add(const char* name, T& value, const char* metavar, const char* help) {
  CLI::Option* option = app_.add_option(name, value, help)->type_name(metavar)->allow_extra_args(false);
  if (option->get_items_expected_max() == 1) option->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
  return Argument(*option);
}

template <class T>
Argument Arguments::add_positional(const char* name, T& value, const char* help) {
  return Argument(*app_.add_option(name, value, help)->type_name(""));
}

Argument Arguments::add_switch(const char* name, bool& value, const char* help) {
  return Argument(*app_.add_flag(name, value, help));
}

Argument Arguments::add_text(const std::string& name, const char* metavar, const char* help,
                             std::function<void(const std::string&)> take) {
  if (!metavar)
    return Argument(*app_.add_flag_callback(
        name, [take] { take("on"); }, help));
  return Argument(*app_.add_option_function<std::string>(name, take, help)
                       ->type_name(metavar)
                       ->multi_option_policy(CLI::MultiOptionPolicy::TakeLast));
}

bool Arguments::has(const std::string& name) const { return app_.get_option_no_throw(name) != nullptr; }

void Arguments::footer(const char* text) { app_.footer(text); }

// What the commands use.
using Text = std::string;
using Path = std::filesystem::path;
template Argument Arguments::add(const char*, Text&, const char*, const char*);
template Argument Arguments::add(const char*, Path&, const char*, const char*);
template Argument Arguments::add(const char*, int&, const char*, const char*);
template Argument Arguments::add(const char*, double&, const char*, const char*);
template Argument Arguments::add(const char*, std::uint64_t&, const char*, const char*);
template Argument Arguments::add(const char*, std::optional<double>&, const char*, const char*);
template Argument Arguments::add(const char*, std::vector<Text>&, const char*, const char*);
template Argument Arguments::add(const char*, std::vector<Path>&, const char*, const char*);
template Argument Arguments::add(const char*, std::vector<double>&, const char*, const char*);
template Argument Arguments::add(const char*, std::vector<std::uint64_t>&, const char*, const char*);
template Argument Arguments::add_positional(const char*, Text&, const char*);
template Argument Arguments::add_positional(const char*, Path&, const char*);
template Argument Arguments::add_positional(const char*, std::vector<Text>&, const char*);
template Argument Arguments::add_positional(const char*, std::vector<Path>&, const char*);

}  // namespace castray::cli
