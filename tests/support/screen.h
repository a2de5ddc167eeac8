#pragma once

#include <algorithm>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

/// What a terminal of some size shows after a text: as much of ECMA-48 and xterm as castray writes. Colours
/// are left out. Throws what() on any other sequence.
class Screen {
 public:
  Screen(int columns, int rows) : columns_(columns), rows_(rows), lines_(static_cast<std::size_t>(rows)) {}

  void show(std::string_view text) {
    while (!text.empty()) text.remove_prefix(step(text));
  }

  /// Some line was longer than the screen is wide, or there were more than it is high.
  bool wrapped() const { return wrapped_; }
  bool scrolled() const { return scrolled_; }
  bool is_own() const { return is_own_; }  ///< of the program, not the shell's
  bool shows_cursor() const { return shows_cursor_; }
  /// Of what one of `row` shows, in characters.
  int width(int row) const {
    const auto& line = lines_[static_cast<std::size_t>(row)];
    return static_cast<int>(line.size());
  }
  std::string line(int row) const {
    std::string all;
    for (const std::string& character : lines_[static_cast<std::size_t>(row)]) all += character;
    return all;
  }

 private:
  static constexpr char escape = '\x1b';

  static std::size_t length_of(char first) {
    const auto byte = static_cast<unsigned char>(first);
    return byte < 0x80 ? 1 : byte < 0xe0 ? 2 : byte < 0xf0 ? 3 : 4;
  }

  /// Takes one character or sequence; returns its bytes. One that the next sequence cuts short ends there.
  std::size_t step(std::string_view text) {
    if (text[0] == escape) return sequence(text);
    if (text[0] == '\r') return column_ = 0, 1;
    if (text[0] == '\n') return line_feed(), 1;
    const std::size_t length = std::min(length_of(text[0]), text.find(escape));
    put(std::string(text.substr(0, length)));
    return length;
  }

  void put(const std::string& character) {
    if (column_ == columns_) {
      wrapped_ = true;
      column_ = 0;
      line_feed();
    }
    auto& line = lines_[static_cast<std::size_t>(row_)];
    if (static_cast<int>(line.size()) <= column_) line.resize(static_cast<std::size_t>(column_) + 1, " ");
    line[static_cast<std::size_t>(column_++)] = character;
  }

  void line_feed() {
    if (++row_ < rows_) return;
    row_ = rows_ - 1;
    scrolled_ = true;
    lines_.erase(lines_.begin());
    lines_.emplace_back();
  }

  std::size_t sequence(std::string_view text) {
    if (text.size() > 1 && text[1] == escape) return 1;
    const std::size_t end = text.find_first_not_of("0123456789;?", 2);
    if (text.size() < 3 || text[1] != '[' || end == text.npos)
      throw std::runtime_error("an escape sequence that is none");
    if (text[end] == escape) return end;
    obey(std::string(text.substr(2, end - 2)), text[end]);
    return end + 1;
  }

  void obey(const std::string& parameters, char verb) {
    if (verb == 'm') return;
    if (verb == 'H') {
      row_ = parameters.empty() ? 0 : std::min(std::atoi(parameters.c_str()), rows_) - 1;
      column_ = 0;
    } else if (verb == 'K' && parameters.empty()) {
      auto& line = lines_[static_cast<std::size_t>(row_)];
      line.resize(std::min(line.size(), static_cast<std::size_t>(column_)));
    } else if (verb == 'J' && parameters == "2") {
      lines_.assign(lines_.size(), {});
    } else if (parameters == "?1049") {
      is_own_ = verb == 'h';
    } else if (parameters == "?25") {
      shows_cursor_ = verb == 'h';
    } else {
      throw std::runtime_error("unknown sequence " + parameters + verb);
    }
  }

  int columns_, rows_, column_ = 0, row_ = 0;
  std::vector<std::vector<std::string>> lines_;  ///< by line, its characters
  bool wrapped_ = false, scrolled_ = false, is_own_ = false, shows_cursor_ = true;
};
