#include "scene/line_reader.h"

#include <fmt/core.h>

#include <charconv>

#include "core/text.h"
#include "scene/names.h"

namespace castray {

namespace {

/// Takes the first line off `text`, its end included.
std::string_view take_line(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
  const std::string_view line = text.substr(0, end);
  if (end < text.size()) end += text.substr(end).starts_with("\r\n") ? 2 : 1;
  text.remove_prefix(end);
  return line;
}

/// By its byte order mark, or by the zero byte of its first ASCII letters.
bool is_utf16(std::string_view text) {
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
         (text.size() >= 4 && (text[0] == 0) != (text[1] == 0) && (text[0] == 0) == (text[2] == 0) &&
          (text[1] == 0) == (text[3] == 0));
}

}  // namespace

std::optional<double> parse_number(std::string_view word, bool* out_of_range) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.begin(), word.end(), value);
  if (out_of_range) *out_of_range = error == std::errc::result_out_of_range;
  if (error != std::errc() || end != word.end()) return std::nullopt;
  return value;
}

LineReader::LineReader(std::string_view text, const std::string& file)
    : text_(without_bom(text)), file_(file) {
  if (is_utf16(text)) throw InputError(SourcePlace{file}, "is UTF-16; save it as UTF-8");
}

void LineReader::fail(const std::string& what) const {
  SourcePlace where = place();
  if (line_begin_)
    for (const char* c = line_begin_; c <= word_begin_; ++c)
      where.column += c == word_begin_ || (static_cast<unsigned char>(*c) & 0xc0) != 0x80;  // characters
  throw InputError(where, what);
}

void LineReader::join_continued_lines() {
  joined_.clear();
  while (line_.ends_with('\\') && !text_.empty()) {
    joined_ += line_.substr(0, line_.size() - 1);
    joined_ += ' ';
    line_ = take_line(text_);
    ++lines_used_;
  }
  joined_ += line_;
  line_ = joined_;
  line_begin_ = nullptr;
}

bool LineReader::next_line() {
  while (!text_.empty()) {
    line_number_ += lines_used_;
    line_ = take_line(text_);
    if (line_number_ == 0) line_number_ = 1;
    lines_used_ = 1;
    line_begin_ = line_.data();
    if (line_.ends_with('\\') && !trimmed(line_).starts_with('#')) join_continued_lines();
    line_ = trimmed(line_);
    word_begin_ = line_.data();
    if (!line_.empty() && line_.front() != '#') return true;
  }
  return false;
}

std::string_view LineReader::word() {
  std::size_t begin = 0;
  while (begin < line_.size() && is_space(line_[begin])) ++begin;
  if (begin < line_.size() && line_[begin] == '#') begin = line_.size();
  std::size_t end = begin;
  while (end < line_.size() && !is_space(line_[end])) ++end;
  const std::string_view found = line_.substr(begin, end - begin);
  word_begin_ = found.data();
  line_.remove_prefix(end);
  return found;
}

std::string_view LineReader::peek() {
  const std::string_view line = line_;
  const std::string_view found = word();
  line_ = line;
  return found;
}

std::string_view LineReader::rest() {
  const std::string_view found = trimmed(line_);
  word_begin_ = found.data();
  line_ = {};
  return found;
}

std::optional<double> LineReader::number(std::string_view of) {
  const std::string_view digits = word();
  if (digits.empty()) return std::nullopt;
  bool out_of_range = false;
  const std::optional<double> value = parse_number(digits, &out_of_range);
  if (!value)
    fail(fmt::format("'{}' is {}, in '{}'", printable(digits), out_of_range ? "out of range" : "not a number",
                     of));
  return value;
}

double LineReader::required_number(std::string_view of) {
  const std::optional<double> value = number(of);
  if (!value) fail(fmt::format("'{}' needs more numbers", of));
  return *value;
}

}  // namespace castray
