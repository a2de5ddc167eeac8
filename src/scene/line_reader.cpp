#include "scene/line_reader.h"

#include <fmt/core.h>

#include <charconv>

#include "core/text.h"

namespace castray {

namespace {

constexpr bool is_space(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f' || c == '\0'; }

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
  return text;
}

/// Takes the first line off `text`, its end included.
std::string_view take_line(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && text[end] != '\n' && text[end] != '\r') ++end;
  const std::string_view line = text.substr(0, end);
  if (end < text.size()) end += text.substr(end).starts_with("\r\n") ? 2 : 1;
  text.remove_prefix(end);
  return line;
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
    : text_(without_bom(text)), file_(file) {}

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
}

bool LineReader::next_line() {
  while (!text_.empty()) {
    line_number_ += lines_used_;
    line_ = take_line(text_);
    if (line_number_ == 0) line_number_ = 1;
    lines_used_ = 1;
    if (line_.ends_with('\\')) join_continued_lines();
    line_ = trimmed(line_);
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
