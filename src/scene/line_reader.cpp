#include "scene/line_reader.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "core/text.h"
#include "scene/names.h"

namespace castray {

std::optional<double> parse_number(std::string_view word, bool* out_of_range) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.begin(), word.end(), value);
  if (out_of_range) *out_of_range = error == std::errc::result_out_of_range;
  // "1.#INF", "-1.#IND00": what is not finite, as older libraries of Microsoft print it
  if (end != word.begin() && end != word.end() && end[-1] == '.' && *end == '#')
    return std::numeric_limits<double>::quiet_NaN();
  if (error != std::errc() || end != word.end()) return std::nullopt;
  return value;
}

LineReader::LineReader(std::string_view text, const std::string& file)
    : text_(without_bom(text)), file_(file) {
  if (const std::string why = why_no_text(text); !why.empty()) throw InputError(SourcePlace{file}, why);
}

SourcePlace LineReader::word_place() const {
  SourcePlace where = place();
  if (line_begin_)
    for (const char* c = line_begin_; c <= word_begin_; ++c)
      where.column += c == word_begin_ || (static_cast<unsigned char>(*c) & 0xc0) != 0x80;  // characters
  return where;
}

void LineReader::fail(const std::string& what) const { throw InputError(word_place(), what); }

/// Takes the first line off the text, its end included. A text of CRs alone is looked through for LF once.
std::string_view LineReader::take_line() {
  if (text_.data() > line_feed_ || !line_feed_)
    line_feed_ = text_.data() + std::min(text_.find('\n'), text_.size());
  const auto before_line_feed = static_cast<std::size_t>(line_feed_ - text_.data());
  const std::size_t end = std::min(text_.substr(0, before_line_feed).find('\r'), before_line_feed);
  const std::string_view line = text_.substr(0, end);
  const std::size_t whole =
      end + (end < text_.size()) + (end + 1 == before_line_feed && end + 1 < text_.size());
  text_.remove_prefix(whole);
  return line;
}

void LineReader::join_continued_lines() {
  joined_.clear();
  while (line_.ends_with('\\') && !text_.empty()) {
    joined_ += line_.substr(0, line_.size() - 1);
    joined_ += ' ';
    line_ = trimmed(take_line());
    ++lines_used_;
  }
  joined_ += line_;
  line_ = joined_;
  line_begin_ = nullptr;
}

bool LineReader::next_line() {
  while (!text_.empty()) {
    line_number_ += lines_used_;
    line_ = take_line();
    if (line_number_ == 0) line_number_ = 1;
    lines_used_ = 1;
    line_begin_ = line_.data();
    line_ = trimmed(line_);
    if (line_.ends_with('\\') && !line_.starts_with('#')) join_continued_lines();
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
