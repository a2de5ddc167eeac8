#include "scene/json_document.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "core/text.h"

namespace castray {

namespace {

using Json = nlohmann::json;

/// Lines and columns of increasing byte offsets.
class PlaceCounter {
 public:
  PlaceCounter(std::string_view text, const std::string& file) : text_(text), place_{file, 1, 1} {}

  const SourcePlace& at(std::size_t offset) {
    for (; offset_ < std::min(offset, text_.size()); ++offset_) {
      const char c = text_[offset_];
      const bool continues_character = (static_cast<unsigned char>(c) & 0xc0) == 0x80;
      if (c == '\n') {
        ++place_.line;
        place_.column = 1;
      } else if (!continues_character) {
        ++place_.column;
      }
    }
    return place_;
  }

 private:
  std::string_view text_;
  std::size_t offset_ = 0;
  SourcePlace place_;
};

/// Builds the tree from the parser's events. These carry no position, but come in the order of the text's
/// tokens, so a cursor that walks over the tokens knows where each begins.
class TreeBuilder : public nlohmann::json_sax<Json> {
 public:
  TreeBuilder(std::string_view text, const std::string& file) : text_(text), places_(text, file) {}

  JsonNode root;

  bool null() override { return add({}); }
  bool boolean(bool value) override { return add({.type = Type::boolean, .number = value ? 1.0 : 0.0}); }
  bool number_integer(number_integer_t value) override { return add_number(static_cast<double>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return add_number(static_cast<double>(value)); }
  bool number_float(number_float_t value, const string_t&) override { return add_number(value); }
  bool string(string_t& value) override { return add({.type = Type::string, .text = std::move(value)}); }
  bool binary(binary_t&) override { return false; }

  bool start_object(std::size_t) override { return open(Type::object); }
  bool start_array(std::size_t) override { return open(Type::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    key_place_ = next_token();
    if (!keys_.back().insert(name).second)
      throw InputError(key_place_, "'" + printable(name) + "' is there twice; remove one");
    key_ = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&,
                   const nlohmann::detail::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: what"
    std::string what = error.what();
    for (const char* prefix_end : {"] ", ": "}) {
      const std::size_t found = what.find(prefix_end);
      if (found != std::string::npos) what.erase(0, found + 2);
    }
    std::replace_if(
        what.begin(), what.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20; }, ' ');
    throw InputError(places_.at(position > 0 ? position - 1 : 0), "not valid JSON: " + printable(what, 200));
  }

 private:
  using Type = JsonNode::Type;

  // More than any scene has; bounds the memory.
  static constexpr int most_values = 1'000'000;

  // Deeper than any scene; the tree is walked and destroyed by recursion.
  static constexpr std::size_t greatest_depth = 64;

  /// As the parser does: to a line's end, which may be CR, or a zero byte; or to "*/".
  void skip_comment() {
    const bool is_line = text_.substr(cursor_).starts_with("//");
    const std::size_t end =
        is_line ? text_.find_first_of(std::string_view("\n\r\0", 3), cursor_) : text_.find("*/", cursor_ + 2);
    cursor_ = end == std::string_view::npos ? text_.size() : end + (is_line ? 1 : 2);
  }

  void skip_string() {
    for (++cursor_; cursor_ < text_.size() && text_[cursor_] != '"'; ++cursor_)
      if (text_[cursor_] == '\\') ++cursor_;
    ++cursor_;
  }

  /// The place of the next token; moves behind it.
  SourcePlace next_token() {
    while (cursor_ < text_.size()) {
      if (text_[cursor_] == '/') {
        skip_comment();
      } else if (std::string_view(" \t\r\n,:").find(text_[cursor_]) != std::string_view::npos) {
        ++cursor_;
      } else {
        break;
      }
    }
    const SourcePlace place = places_.at(cursor_);
    token_begin_ = cursor_;
    if (cursor_ >= text_.size()) return place;
    if (text_[cursor_] == '"') {
      skip_string();
    } else if (std::string_view("{}[]").find(text_[cursor_]) != std::string_view::npos) {
      ++cursor_;
    } else {
      cursor_ = std::min(text_.find_first_of(" \t\r\n,:{}[]/\"", cursor_), text_.size());
    }
    return place;
  }

  bool add(JsonNode node) {
    node.place = next_token();
    if (++values_ > most_values)
      throw InputError(node.place, "more than " + std::to_string(most_values) + " values; is this a scene?");
    if (open_.empty()) {
      root = std::move(node);
      return true;
    }
    if (open_.back()->type == Type::object) {
      node.key = std::move(key_);
      node.key_place = key_place_;
    }
    open_.back()->children.push_back(std::move(node));
    return true;
  }

  bool add_number(double value) {
    add({.type = Type::number, .number = value});
    JsonNode& node = open_.empty() ? root : open_.back()->children.back();
    node.text = text_.substr(token_begin_, cursor_ - token_begin_);
    return true;
  }

  bool open(Type type) {
    add({.type = type});
    open_.push_back(open_.empty() ? &root : &open_.back()->children.back());
    keys_.emplace_back();
    if (open_.size() > greatest_depth)
      throw InputError(open_.back()->place,
                       "nested deeper than " + std::to_string(greatest_depth) + " levels");
    return true;
  }

  bool close() {
    next_token();
    open_.pop_back();
    keys_.pop_back();
    return true;
  }

  std::string_view text_;
  PlaceCounter places_;
  std::size_t cursor_ = 0, token_begin_ = 0;
  int values_ = 0;
  std::vector<JsonNode*> open_;              ///< a parent's children do not move while one of them is open
  std::vector<std::set<std::string>> keys_;  ///< so far, of each open value
  std::string key_;
  SourcePlace key_place_;
};

}  // namespace

const char* JsonNode::type_name() const {
  constexpr const char* names[] = {"null", "a boolean", "a number", "a string", "an array", "an object"};
  return names[static_cast<int>(type)];
}

JsonNode parse_json(std::string_view text, const std::string& file) {
  if (const std::string why = why_no_text(text); !why.empty()) throw InputError(SourcePlace{file}, why);
  text = without_bom(text);
  TreeBuilder builder(text, file);
  constexpr bool strict = true, ignore_comments = true;
  Json::sax_parse(text.begin(), text.end(), &builder, Json::input_format_t::json, strict, ignore_comments);
  return std::move(builder.root);
}

}  // namespace castray
