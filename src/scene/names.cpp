#include "scene/names.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>

namespace castray {

namespace {

std::string_view unquoted(std::string_view text) {
  for (const char quote : {'"', '\''})
    if (text.size() >= 2 && text.front() == quote && text.back() == quote)
      return text.substr(1, text.size() - 2);
  return text;
}

std::string unescaped(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.substr(i).starts_with("%20")) {
      result += ' ';
      i += 2;
    } else if (!(text[i] == '\\' && i + 1 < text.size() && (text[i + 1] == ' ' || text[i + 1] == '"'))) {
      result += text[i];
    }
  }
  return result;
}

}  // namespace

std::string_view without_comment(std::string_view text) {
  const std::vector<std::string_view> shortened = without_comments(text);
  return shortened.empty() ? text : shortened.back();
}

std::vector<std::string_view> without_comments(std::string_view text) {
  std::vector<std::string_view> all;
  for (std::size_t i = text.size(); i-- > 0;)
    if (text[i] == '#' && (i == 0 || is_space(text[i - 1]))) all.push_back(trimmed(text.substr(0, i)));
  return all;
}

std::vector<std::string> spellings(std::string_view text) {
  std::vector<std::string> all;
  for (std::string spelling : {std::string(text), std::string(unquoted(text)), unescaped(unquoted(text))})
    if (std::ranges::find(all, spelling) == all.end()) all.push_back(std::move(spelling));
  return all;
}

std::vector<std::string> readings(std::string_view text) {
  std::vector<std::string> all = spellings(text);
  for (const std::string_view shortened : without_comments(text))
    for (std::string& spelling : spellings(shortened))
      if (std::ranges::find(all, spelling) == all.end()) all.push_back(std::move(spelling));
  return all;
}

std::vector<std::string> without_repeats(std::vector<std::string> names) {
  std::set<std::string> taken;
  std::map<std::string, int> last;  // number that a name got
  for (std::string& name : names) {
    if (taken.insert(name).second) continue;
    int& n = last.try_emplace(name, 1).first->second;
    const std::string wanted = std::move(name);
    do name = wanted + " " + std::to_string(++n);
    while (!taken.insert(name).second);
  }
  return names;
}

std::string lower_case(std::string_view text) {
  std::string result(text);
  std::ranges::transform(result, result.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return result;
}

}  // namespace castray
