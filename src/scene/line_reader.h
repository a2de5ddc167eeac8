#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "castray/error.h"

namespace castray {

/// A whole word as a number, "nan" and "inf" among them; nothing where it is none. Sets `out_of_range` where
/// it is too large or too small for a double.
std::optional<double> parse_number(std::string_view word, bool* out_of_range = nullptr);

/// Walks over the lines of an OBJ or MTL text and the words of each line. Lines may end in LF, CR or CRLF; a
/// backslash in front of the line's end continues it; a '#' in front of a word begins a comment.
class LineReader {
 public:
  /// Throws InputError where it is no text (`why_no_text`).
  LineReader(std::string_view text, const std::string& file);

  /// Goes to the next line that holds anything. False at the end.
  bool next_line();

  /// Whether nothing is left of the line.
  bool at_end() const { return line_.empty(); }

  /// The next word of the line, or empty.
  std::string_view word();
  /// The same, but stays in front of it.
  std::string_view peek();
  /// What is left of the line without surrounding space; for names that may contain spaces.
  std::string_view rest();

  /// The next word as a number, "nan" and "inf" among them; nothing at the line's end. Throws InputError
  /// where the word is no number. `of` is the statement, for the message.
  std::optional<double> number(std::string_view of);
  double required_number(std::string_view of);

  /// The line, without a column.
  SourcePlace place() const { return {file_, line_number_, 0}; }
  /// Of the word that was read last.
  SourcePlace word_place() const;
  /// Throws InputError at the word that was read last.
  [[noreturn]] void fail(const std::string& what) const;

 private:
  std::string_view take_line();
  void join_continued_lines();

  std::string_view text_;
  const char* line_feed_ = nullptr;   ///< the next one in text_, or its end; null: not looked for yet
  std::string_view line_;             ///< what is left of the line
  const char* line_begin_ = nullptr;  ///< of the whole line; null where it is continued
  const char* word_begin_ = nullptr;  ///< of the word that was read last
  std::string joined_;                ///< the line, where it is continued
  std::string file_;
  int line_number_ = 0, lines_used_ = 0;
};

}  // namespace castray
