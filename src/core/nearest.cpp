#include "core/nearest.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "core/text.h"

namespace castray {

namespace {

// Longer words are not typing errors of anything we know.
constexpr std::size_t longest_word = 64;

/// Edits (insert, delete, replace, swap of neighbours) that turn `a` into `b`: optimal string alignment.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, above(b.size() + 1), row(b.size() + 1);
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before = above;
    above = row;
  }
  return above.back();
}

}  // namespace

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& known) {
  if (word.size() > longest_word) return {};
  std::string_view best;
  std::size_t least = 1 + std::max<std::size_t>(1, word.size() / 3);
  for (std::string_view name : known) {
    const std::size_t distance = edit_distance(word, name);
    if (distance < least) {
      least = distance;
      best = name;
    }
  }
  return best;
}

std::string suggestion(std::string_view word, const std::vector<std::string_view>& known) {
  const std::string_view near = nearest(word, known);
  if (!near.empty()) return "; did you mean '" + std::string(near) + "'?";
  std::string list = "; known: ";
  for (std::string_view name : known) {
    if (name != known.front()) list += ", ";
    list += name;
  }
  return list;
}

std::string not_found(std::string_view kind, std::string_view name,
                      const std::vector<std::string_view>& known) {
  return fmt::format(
      "{} '{}' not found{}", kind, printable(name),
      known.empty() ? fmt::format("; the scene has no \"{}s\"", kind) : suggestion(name, known));
}

}  // namespace castray
