#pragma once

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

#include <fmt/core.h>

#include "castray/error.h"
#include "core/text.h"
#include "scene/line_reader.h"
#include "scene/names.h"
#include "scene/ply_header.h"

// The numbers behind the head of a PLY file, one after the other: next() reads one of a type, place() is that
// of the last one as far as messages tell it, fail() throws InputError that says where the last one is.

namespace castray {

class PlyBinaryValues {
 public:
  PlyBinaryValues(std::string_view text, const PlyHeader& header, const std::filesystem::path& file)
      : text_(text),
        file_(&file),
        at_(header.size),
        swap_((header.encoding == PlyEncoding::big_endian) != (std::endian::native == std::endian::big)) {}

  double next(PlyType type) {
    switch (type) {
      case PlyType::int8:
        return take<std::int8_t>();
      case PlyType::uint8:
        return take<std::uint8_t>();
      case PlyType::int16:
        return take<std::int16_t>();
      case PlyType::uint16:
        return take<std::uint16_t>();
      case PlyType::int32:
        return take<std::int32_t>();
      case PlyType::uint32:
        return take<std::uint32_t>();
      case PlyType::float32:
        return double{take<float>()};
      case PlyType::float64:
        break;
    }
    return take<double>();
  }

  /// Of a number of this type, at least.
  static std::size_t bytes_of(PlyType type) { return size_of(type); }
  std::size_t bytes_left() const { return text_.size() - at_; }

  SourcePlace place() const { return {file_->string()}; }

  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(SourcePlace{file_->string()}, fmt::format("at byte {}: {}", last_, what));
  }

 private:
  template <class T>
  T take() {
    last_ = at_;
    if (bytes_left() < sizeof(T)) fail("the file is truncated");
    char bytes[sizeof(T)];
    std::memcpy(bytes, text_.data() + at_, sizeof(T));
    if (swap_) std::reverse(bytes, bytes + sizeof(T));
    at_ += sizeof(T);
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    return value;
  }

  std::string_view text_;
  const std::filesystem::path* file_;
  std::size_t at_, last_ = 0;
  bool swap_;
};

class PlyTextValues {
 public:
  PlyTextValues(std::string_view text, const PlyHeader& header, const std::filesystem::path& file)
      : text_(text), file_(&file), at_(header.size), line_(header.lines + 1) {}

  double next(PlyType) {
    for (; at_ < text_.size() && (is_space(text_[at_]) || is_line_end(text_[at_])); ++at_)
      line_ += text_[at_] == '\n' || (text_[at_] == '\r' && !text_.substr(at_).starts_with("\r\n"));
    std::size_t end = at_;
    while (end < text_.size() && !is_space(text_[end]) && !is_line_end(text_[end])) ++end;
    const std::string_view word = text_.substr(at_, end - at_);
    if (word.empty()) fail("the file is truncated");
    at_ = end;
    const std::optional<double> value = parse_number(word);
    if (!value) fail(fmt::format("'{}' is not a number", printable(word)));
    return *value;
  }

  static std::size_t bytes_of(PlyType) { return 2; }  // a digit and a space
  std::size_t bytes_left() const { return text_.size() - at_ + 1; }

  SourcePlace place() const { return {file_->string(), line_}; }
  [[noreturn]] void fail(const std::string& what) const { throw InputError(place(), what); }

 private:
  static bool is_line_end(char c) { return c == '\n' || c == '\r'; }

  std::string_view text_;
  const std::filesystem::path* file_;
  std::size_t at_;
  int line_;
};

}  // namespace castray
