#include "core/text.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace castray {

std::string printable(std::string_view text, std::size_t longest) {
  std::string result(text.substr(0, longest));
  for (char& c : result)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
  if (text.size() > longest) result += "...";
  return result;
}

std::string two_digits(double value) {
  if (value < 99.5) return fmt::format("{:.2g}", value);
  if (!(value < 995e3)) return "more than a million";
  const double unit = std::pow(10, std::floor(std::log10(value * 1.005)) - 1);
  return fmt::format("{:.0f}", std::round(value / unit) * unit);
}

std::string escape_item(std::string_view text) {
  constexpr std::string_view digits = "0123456789ABCDEF";
  std::string result;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte < 0x20 || byte == 0x7f || c == '%' || c == ';' || c == '=')
      result += {'%', digits[byte >> 4], digits[byte & 15]};
    else
      result += c;
  }
  return result;
}

std::string unescape_item(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    const char* const end = text.data() + std::min(i + 3, text.size());
    if (text[i] == '%' && std::from_chars(text.data() + i + 1, end, byte, 16).ptr == text.data() + i + 3) {
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

namespace {

/// By its byte order mark, or by the zero byte of its first ASCII letters.
bool is_utf16(std::string_view text) {
  return text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff") ||
         (text.size() >= 4 && (text[0] == 0) != (text[1] == 0) && (text[0] == 0) == (text[2] == 0) &&
          (text[1] == 0) == (text[3] == 0));
}

struct Packer {
  const char* name;
  std::string_view magic;
};
constexpr Packer packers[] = {{"gzip", "\x1f\x8b"},
                              {"zip", "PK\x03\x04"},
                              {"bzip2", "BZh"},
                              {"xz",
                               "\xfd"
                               "7zXZ"},
                              {"7-Zip", "7z\xbc\xaf"},
                              {"zstd", "\x28\xb5\x2f\xfd"},
                              {"RAR", "Rar!"}};

}  // namespace

std::string why_no_text(std::string_view bytes) {
  for (const Packer& packer : packers)
    if (bytes.starts_with(packer.magic))
      return std::string("is packed by ") + packer.name + "; unpack it first";
  if (is_utf16(bytes)) return "is UTF-16; save it as UTF-8";
  constexpr std::size_t looked_at = 512;
  if (bytes.substr(0, looked_at).find('\0') != bytes.npos)
    return "is binary, not a text; is it another format?";
  return {};
}

std::string_view without_bom(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

}  // namespace castray
