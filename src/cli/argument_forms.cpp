#include "cli/argument_forms.h"

#include <cctype>
#include <string_view>

#include "castray/image.h"

namespace castray::cli {

namespace {

using Words = std::vector<std::string>;

bool is_flag(const std::string& word) { return word.size() > 1 && word[0] == '-'; }

bool is_output_flag(const std::string& word) { return word == "-o" || word == "--output"; }

/// -o=FILE in two words; others as they are.
void add_parted(Words& words, const std::string& word) {
  if (word.size() > 2 && word[0] == '-' && std::isalpha(static_cast<unsigned char>(word[1])) &&
      word[2] == '=')
    words.insert(words.end(), {word.substr(0, 2), word.substr(3)});
  else
    words.push_back(word);
}

/// Whether a word that follows -o FILE is one more output: no input of `command` looks like it.
bool is_further_output(std::string_view command, const std::string& word, bool has_input) {
  if (word.starts_with('-') || !is_image_format(word)) return false;
  if (command == "merge") return !is_film_format(word);
  return command == "render" || (command == "convert" && has_input);
}

}  // namespace

std::vector<std::string> plain_arguments(const std::vector<std::string>& words) {
  if (words.empty()) return {};
  if (words[0] == "help") {
    Words asked(words.begin() + 1, words.end());
    std::erase(asked, "help");
    asked.push_back("--help");
    return asked;
  }
  Words plain;
  bool has_input = false, follows_output = false;
  for (const std::string& word : words) {
    const bool has_flag_before = !plain.empty() && is_flag(plain.back());
    if (follows_output && is_further_output(words[0], word, has_input)) {
      plain.insert(plain.end(), {"-o", word});
      continue;
    }
    follows_output = has_flag_before && is_output_flag(plain.back());
    has_input |= !plain.empty() && !has_flag_before && !is_flag(word);
    add_parted(plain, word);
    follows_output |= word.starts_with("-o=") || word.starts_with("--output=");
  }
  return plain;
}

}  // namespace castray::cli
