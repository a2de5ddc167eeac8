#include "scene/ply_header.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <charconv>

#include "castray/error.h"
#include "core/nearest.h"
#include "core/text.h"
#include "scene/names.h"

namespace castray {

namespace {

/// Each type by the two names that are in use, and its size.
struct TypeName {
  std::string_view name, other;
  std::size_t size;
};
constexpr std::array<TypeName, 8> types{{{"char", "int8", 1},
                                         {"uchar", "uint8", 1},
                                         {"short", "int16", 2},
                                         {"ushort", "uint16", 2},
                                         {"int", "int32", 4},
                                         {"uint", "uint32", 4},
                                         {"float", "float32", 4},
                                         {"double", "float64", 8}}};

class HeaderReader {
 public:
  HeaderReader(std::string_view text, const std::filesystem::path& file, WarningList& warnings)
      : text_(text), file_(file), warnings_(warnings) {}

  PlyHeader read() {
    if (!text_.starts_with("ply"))
      if (const std::string why = why_no_text(text_); !why.empty()) throw InputError({file_.string()}, why);
    next_line();
    if (word() != "ply") fail("not a PLY file: its first line is not 'ply'");
    bool has_format = false;
    for (;;) {
      next_line();
      const std::string_view key = word();
      if (key == "end_header") break;
      if (key == "format") {
        read_format();
        has_format = true;
      } else if (key == "element") {
        read_element();
      } else if (key == "property") {
        read_property();
      } else if (key == "comment") {
        if (word() == "TextureFile") header_.texture = trimmed(line_);
      } else if (!key.empty() && key != "obj_info") {
        pass_over(key);
      }
    }
    if (!has_format) fail("the header has no line 'format'");
    header_.size = at_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw InputError(SourcePlace{file_.string(), header_.lines}, what);
  }

  /// All lines end as the first does: binary data may begin with what looks like a line's end.
  void next_line() {
    if (line_end_.empty()) {
      const std::size_t end = text_.find_first_of("\r\n");
      line_end_ = text_.substr(std::min(end, text_.size()),
                               text_.substr(std::min(end, text_.size())).starts_with("\r\n") ? 2 : 1);
      if (line_end_.empty()) line_end_ = "\n";
    }
    ++header_.lines;
    const std::size_t end = text_.find(line_end_, at_);
    if (end == text_.npos) fail("the header has no line 'end_header'");
    line_ = text_.substr(at_, end - at_);
    at_ = end + line_end_.size();
  }

  std::string_view word() {
    line_ = trimmed(line_);
    const std::string_view found = line_.substr(0, std::min(line_.find_first_of(" \t"), line_.size()));
    line_.remove_prefix(found.size());
    return found;
  }

  /// Some programs' remarks have no "comment" in front; what is nearly a word of the format is none.
  void pass_over(std::string_view key) {
    const std::string what = fmt::format("unknown word '{}' in the header", printable(key));
    const std::string_view meant = nearest(key, {"format", "element", "property", "end_header"});
    if (!meant.empty()) fail(fmt::format("{}; did you mean '{}'?", what, meant));
    warnings_.add({file_.string(), header_.lines}, what + "; its line is left out", Harm::none);
  }

  void read_format() {
    const std::string_view name = word();
    constexpr std::string_view names[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    const auto found = std::ranges::find(names, name);
    if (found == std::end(names))
      fail(fmt::format("unknown format '{}'; known: ascii, binary_little_endian, binary_big_endian",
                       printable(name)));
    header_.encoding = static_cast<PlyEncoding>(found - std::begin(names));
  }

  void read_element() {
    const std::string name(word());
    const std::string_view digits = word();
    std::uint64_t count = 0;
    const auto [end, error] = std::from_chars(digits.begin(), digits.end(), count);
    if (error != std::errc() || end != digits.end())
      fail(fmt::format("'{}' is not a number of elements", printable(digits)));
    header_.elements.push_back({name, count});
  }

  void read_property() {
    if (header_.elements.empty()) fail("a property in front of the first element");
    PlyProperty property;
    const std::string_view first = word();
    if (first == "list") property.count = read_type(word());
    if (property.count && *property.count >= PlyType::float32) fail("the length of a list is a whole number");
    property.type = read_type(property.count ? word() : first);
    property.name = word();
    header_.elements.back().properties.push_back(std::move(property));
  }

  PlyType read_type(std::string_view name) const {
    for (std::size_t i = 0; i < types.size(); ++i)
      if (name == types[i].name || name == types[i].other) return static_cast<PlyType>(i);
    fail(fmt::format("unknown type '{}' of a property", printable(name)));
  }

  std::string_view text_, line_, line_end_;
  const std::filesystem::path& file_;
  WarningList& warnings_;
  std::size_t at_ = 0;
  PlyHeader header_;
};

}  // namespace

std::size_t size_of(PlyType type) { return types[static_cast<std::size_t>(type)].size; }

PlyHeader read_ply_header(std::string_view text, const std::filesystem::path& file, WarningList& warnings) {
  return HeaderReader(text, file, warnings).read();
}

}  // namespace castray
