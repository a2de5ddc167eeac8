#pragma once

#include <string>
#include <string_view>

namespace castray {

/// `text` as it may stand in a one-line message: control characters as '?', cut after `longest` bytes.
std::string printable(std::string_view text, std::size_t longest = 80);

/// A positive number to two significant digits without an exponent: "0.023", "4.5", "230", "more than a
/// million".
std::string two_digits(double value);

/// Why bytes are no text that is read here, as "is packed by gzip; unpack it first": packed files, UTF-16,
/// and those with zero bytes near their beginning. Empty: nothing speaks against it.
std::string why_no_text(std::string_view bytes);

/// `text` without a UTF-8 byte order mark in front.
std::string_view without_bom(std::string_view text);

/// `text` as the value of a "name=value" item in a list of items separated by "; ": '%', ';', '=' and control
/// characters as "%XX". And back.
std::string escape_item(std::string_view text);
std::string unescape_item(std::string_view text);

}  // namespace castray
