#include "castray/film.h"

#include <fmt/core.h>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include "castray/error.h"
#include "core/text.h"
#include "core/two_sum.h"
#include "core/vector_clones.h"

namespace castray {

namespace {

using Doubles [[gnu::vector_size(4 * sizeof(double))]] = double;
using Pair [[gnu::vector_size(2 * sizeof(double))]] = double;

/// The union of two sets of disjoint ranges, neighbours joined.
std::vector<SampleRange> joined_ranges(std::vector<SampleRange> ranges,
                                       const std::vector<SampleRange>& more) {
  ranges.insert(ranges.end(), more.begin(), more.end());
  std::sort(ranges.begin(), ranges.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<SampleRange> joined;
  for (const SampleRange& range : ranges) {
    if (!joined.empty() && range.first < joined.back().first + joined.back().count)
      throw InputError("both films hold sample " + std::to_string(range.first) +
                       "; render disjoint ranges with --samples FIRST:COUNT");
    if (!joined.empty() && range.first == joined.back().first + joined.back().count)
      joined.back().count += range.count;
    else
      joined.push_back(range);
  }
  return joined;
}

std::string to_string(const Window& w) {
  return fmt::format("{},{},{},{} of {}x{}", w.x0, w.y0, w.x1, w.y1, w.full_width, w.full_height);
}

std::vector<std::string> items_of(const std::string& key) {
  std::vector<std::string> items;
  for (std::size_t at = 0; at < key.size();) {
    const std::size_t end = std::min(key.find("; ", at), key.size());
    items.push_back(key.substr(at, end - at));
    at = end + 2;
  }
  return items;
}

/// The items of `a` that `b` has not.
std::string items_missing(const std::string& a, const std::string& b) {
  const std::vector<std::string> have = items_of(b);
  std::string missing;
  for (const std::string& item : items_of(a))
    if (std::find(have.begin(), have.end(), item) == have.end())
      missing += (missing.empty() ? "" : ", ") + item;
  return missing.empty() ? "nothing more" : missing;
}

std::string difference_of_keys(const std::string& a, const std::string& b) {
  return items_missing(a, b) + " against " + items_missing(b, a);
}

}  // namespace

Film::Film(const Window& window, double brightest)
    : version(CASTRAY_VERSION),
      window_(window),
      scale_(brightest > 0 ? std::exp2(std::ceil(std::log2(brightest))) : 1.0),
      sums_(3 * static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height())),
      counts_(static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height())) {}

Film::Sum& Film::Sum::operator+=(const Sum& other) {
  ExactSum<double> exact;
  two_sum(high, other.high, exact);
  high = exact.sum;
  low += other.low + exact.error;
  return *this;
}

void Film::add(Sum* sums, const Vec3f& radiance) const {
  const double small = scale_ * 0x1p-36;
  const double rounder = scale_ * 0x1.8p-8;  // 1.5 * 2^52 quanta of 2^-60: adding it rounds to a quantum
  const Doubles v = {double{radiance.x}, double{radiance.y}, double{radiance.z}, 0};
  Doubles first, last;  // the pairs of two channels, and of the last two
  std::memcpy(&first, sums, sizeof first);
  std::memcpy(&last, sums + 1, sizeof last);
  const Doubles high = __builtin_shufflevector(first, last, 0, 2, 6, 6),
                low = __builtin_shufflevector(first, last, 1, 3, 7, 7);
  const Doubles rounded = ((v < small) & (v > -small)) ? (v + rounder) - rounder : v;
  ExactSum<Doubles> next;
  two_sum(high, rounded, next);
  next.error += low;
  first = __builtin_shufflevector(next.sum, next.error, 0, 4, 1, 5);
  const Pair pair = __builtin_shufflevector(next.sum, next.error, 2, 6);
  std::memcpy(&sums->high, &first, sizeof first);
  std::memcpy(&sums[2].high, &pair, sizeof pair);
}

CASTRAY_VECTOR_CLONES
void Film::add(int x, int y, const Vec3f& radiance) {
  const std::size_t pixel = index(x, y);
  add(&sums_[3 * pixel], radiance);
  ++counts_[pixel];
}

void Film::keep_splats() {
  splats_.resize(sums_.size());
  light_paths_.resize(counts_.size());
}

void Film::add_light_paths(std::uint64_t count) {
  for (std::uint64_t& paths : light_paths_) paths += count;
}

CASTRAY_VECTOR_CLONES
void Film::add_splat(int x, int y, const Vec3f& radiance) { add(&splats_[3 * index(x, y)], radiance); }

void Film::keep_differences() { differences_ = DifferenceSums(width(), height(), scale_); }

CASTRAY_VECTOR_CLONES
void Film::add(std::span<const TileSamples> tiles, int y0, int y1) {
  for (const TileSamples& tile : tiles) {
    const float share = 1 / static_cast<float>(tile.takes);
    const std::uint32_t counted = tile.take + 1 == tile.takes ? 1 : 0;
    for (std::uint64_t kept = tile.kept; kept != 0; kept &= kept - 1) {
      const int i = std::countr_zero(kept), x = tile.x_of(i), y = tile.y_of(i);
      if (y < y0 || y >= y1) continue;
      const std::size_t pixel = index(x, y);
      add(&sums_[3 * pixel], Vec3f(tile.radiance[0][i], tile.radiance[1][i], tile.radiance[2][i]) * share);
      counts_[pixel] += counted;
    }
  }
  differences_.add(tiles, y0, y1, window_.x0, window_.y0);
}

Vec3d Film::mean(int x, int y) const {
  const std::size_t pixel = index(x, y);
  if (counts_[pixel] == 0) return {};
  const double n = counts_[pixel];
  const Sum* s = &sums_[3 * pixel];
  return Vec3d{s[0].value(), s[1].value(), s[2].value()} / n + mean_of_splats(x, y);
}

Vec3d Film::mean_of_splats(int x, int y) const {
  if (light_paths(x, y) == 0) return {};
  const Sum* s = &splats_[3 * index(x, y)];
  return splats_over_paths({s[0].value(), s[1].value(), s[2].value()}, double(light_paths(x, y)));
}

Vec3d Film::splats_over_paths(const Vec3d& splats, double paths) const {
  return splats * (double(window_.full_width) * window_.full_height / paths);
}

Image Film::image(int threads) const {
  Image image(width(), height());
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < height(); ++y)
    for (int x = 0; x < width(); ++x) image.at(x, y) = Vec3f(mean(window_.x0 + x, window_.y0 + y));
  return image;
}

Film::Blocks Film::blocks_of(const Window& window) {
  const auto last = [](int end) { return (end - 1) / noise_block + 1; };
  return {window.x0 / noise_block, window.y0 / noise_block, last(window.x1), last(window.y1)};
}

void Film::keep_replicates() {
  const Blocks all = blocks();
  const auto columns = static_cast<std::size_t>(all.x1 - all.x0),
             rows = static_cast<std::size_t>(all.y1 - all.y0);
  Replicate replicate{samples.empty() ? 0 : samples.front().first / replicate_length,
                      std::vector<Sum>(3 * columns * rows), std::vector<std::uint64_t>(columns * rows),
                      std::vector<Sum>(keeps_splats() ? 3 * columns * rows : 0),
                      std::vector<std::uint64_t>(keeps_splats() ? columns * rows : 0)};
  for (int y = window_.y0; y < window_.y1; ++y)
    for (int x = window_.x0; x < window_.x1; ++x) {
      const std::size_t block = static_cast<std::size_t>(y / noise_block - all.y0) * columns +
                                static_cast<std::size_t>(x / noise_block - all.x0);
      for (std::size_t c = 0; c < 3; ++c) replicate.sums[3 * block + c] += sums_[3 * index(x, y) + c];
      replicate.counts[block] += counts_[index(x, y)];
      if (!keeps_splats()) continue;
      for (std::size_t c = 0; c < 3; ++c) replicate.splats[3 * block + c] += splats_[3 * index(x, y) + c];
      replicate.light_paths[block] += light_paths(x, y);
    }
  replicates_ = {std::move(replicate)};
}

std::vector<Vec3d> Film::replicate_means(const Blocks& wanted) const {
  const Blocks all = blocks();
  std::vector<Vec3d> means;
  for (const Replicate& replicate : replicates_) {
    Vec3d sum, splats;
    double count = 0, paths = 0;
    for (int y = wanted.y0; y < wanted.y1; ++y)
      for (int x = wanted.x0; x < wanted.x1; ++x) {
        const std::size_t block =
            static_cast<std::size_t>(y - all.y0) * static_cast<std::size_t>(all.x1 - all.x0) +
            static_cast<std::size_t>(x - all.x0);
        const Sum* s = &replicate.sums[3 * block];
        sum += Vec3d{s[0].value(), s[1].value(), s[2].value()};
        count += static_cast<double>(replicate.counts[block]);
        if (replicate.splats.empty()) continue;
        paths += static_cast<double>(replicate.light_paths[block]);
        s = &replicate.splats[3 * block];
        splats += Vec3d{s[0].value(), s[1].value(), s[2].value()};
      }
    Vec3d mean = count > 0 ? sum / count : Vec3d{};
    if (paths > 0) mean += splats_over_paths(splats, paths);
    means.push_back(mean);
  }
  return means;
}

Film Film::without_samples(const Window& window) const {
  Film film(window, scale_);
  film.key = key;
  film.version = version;
  film.planned = planned;
  if (differences_.kept()) film.keep_differences();
  return film;
}

Film Film::part(const Window& window) const {
  Film film = without_samples(window);
  if (keeps_splats()) film.keep_splats();
  const auto columns = static_cast<std::size_t>(window.width());
  const auto copy_row = [&](const auto& from, auto& to, std::size_t each, int y) {
    std::copy_n(&from[each * index(window.x0, y)], each * columns, &to[each * film.index(window.x0, y)]);
  };
  for (int y = window.y0; y < window.y1; ++y) {
    copy_row(sums_, film.sums_, 3, y);
    copy_row(counts_, film.counts_, 1, y);
    if (differences_.kept())
      film.differences_.add_row(0, y - window.y0, differences_, window.x0 - window_.x0, y - window_.y0,
                                film.width());
    if (!keeps_splats()) continue;
    copy_row(splats_, film.splats_, 3, y);
    copy_row(light_paths_, film.light_paths_, 1, y);
  }
  film.samples = samples;
  film.nonfinite_samples = film.missing_samples();  // no others are missing between passes
  return film;
}

std::string Film::difference_from(const Film& other) const {
  if (key != other.key) return difference_of_keys(key, other.key);
  if (version != other.version) return "castray " + version + " against castray " + other.version;
  if (scale_ != other.scale_) return fmt::format("lights of radiance {} against {}", scale_, other.scale_);
  if (differences_.kept() != other.differences_.kept())
    return differences_.kept() ? "one film keeps differences against none" : "no differences against some";
  if (keeps_replicates() == other.keeps_replicates()) return {};
  return keeps_replicates() ? "one film keeps replicates against none" : "no replicates against some";
}

void Film::merge(const Film& other) {
  if (const std::string difference = difference_from(other); !difference.empty())
    throw InputError("the films are of different renders: " + difference);
  if (window_ != other.window_)
    throw InputError("the films show different windows: " + to_string(window_) + " and " +
                     to_string(other.window_));
  samples = joined_ranges(samples, other.samples);
  add(other);
}

void Film::add(const Film& other) {
  if (other.keeps_splats()) keep_splats();
  const Window& w = other.window_;
  const auto columns = static_cast<std::size_t>(w.width());
  for (int y = w.y0; y < w.y1; ++y) {
    const std::size_t to = index(w.x0, y), from = other.index(w.x0, y);
    for (std::size_t i = 0; i < 3 * columns; ++i) sums_[3 * to + i] += other.sums_[3 * from + i];
    for (std::size_t i = 0; i < columns; ++i) counts_[to + i] += other.counts_[from + i];
    if (differences_.kept())
      differences_.add_row(w.x0 - window_.x0, y - window_.y0, other.differences_, 0, y - w.y0, w.width());
    if (!other.keeps_splats()) continue;
    for (std::size_t i = 0; i < 3 * columns; ++i) splats_[3 * to + i] += other.splats_[3 * from + i];
    for (std::size_t i = 0; i < columns; ++i) light_paths_[to + i] += other.light_paths_[from + i];
  }
  for (const Replicate& theirs : other.replicates_) add(theirs, other.blocks());
  nonfinite_samples += other.nonfinite_samples;
}

void Film::add(const Replicate& theirs, const Blocks& their_blocks) {
  const Blocks all = blocks();
  const auto columns = static_cast<std::size_t>(all.x1 - all.x0),
             rows = static_cast<std::size_t>(all.y1 - all.y0);
  auto ours = std::lower_bound(replicates_.begin(), replicates_.end(), theirs.index,
                               [](const Replicate& r, std::uint64_t i) { return r.index < i; });
  if (ours == replicates_.end() || ours->index != theirs.index)
    ours = replicates_.insert(
        ours, {theirs.index, std::vector<Sum>(3 * columns * rows), std::vector<std::uint64_t>(columns * rows),
               std::vector<Sum>(keeps_splats() ? 3 * columns * rows : 0),
               std::vector<std::uint64_t>(keeps_splats() ? columns * rows : 0)});
  std::size_t from = 0;
  for (int y = their_blocks.y0; y < their_blocks.y1; ++y)
    for (int x = their_blocks.x0; x < their_blocks.x1; ++x, ++from) {
      const std::size_t to =
          static_cast<std::size_t>(y - all.y0) * columns + static_cast<std::size_t>(x - all.x0);
      for (std::size_t c = 0; c < 3; ++c) ours->sums[3 * to + c] += theirs.sums[3 * from + c];
      ours->counts[to] += theirs.counts[from];
      if (theirs.splats.empty()) continue;
      for (std::size_t c = 0; c < 3; ++c) ours->splats[3 * to + c] += theirs.splats[3 * from + c];
      ours->light_paths[to] += theirs.light_paths[from];
    }
}

double Film::samples_per_pixel() const {
  const std::uint64_t counted = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  return static_cast<double>(counted + nonfinite_samples) / static_cast<double>(counts_.size());
}

std::uint64_t Film::missing_samples(std::uint64_t counted) const {
  std::uint64_t wanted = 0;
  for (const SampleRange& range : samples) wanted += range.count;
  wanted *= static_cast<std::uint64_t>(width()) * static_cast<std::uint64_t>(height());
  return wanted - std::min(counted + nonfinite_samples, wanted);
}

std::uint64_t Film::missing_samples() const {
  return missing_samples(std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0}));
}

namespace {

/// Of a pixel, in each of the arrays that a film keeps.
std::vector<std::size_t> bytes_by_array(const Film& film) {
  constexpr std::size_t radiance = 3 * 2 * sizeof(double);
  std::vector<std::size_t> bytes{radiance, sizeof(std::uint32_t)};
  if (film.keeps_splats()) bytes.insert(bytes.end(), {radiance, sizeof(std::uint64_t)});
  if (film.differences().kept())
    bytes.insert(bytes.end(), {DifferenceSums::bytes_of_sums, DifferenceSums::bytes_of_counts});
  return bytes;
}

}  // namespace

std::size_t bytes_of_pixel(const Film& film) {
  const std::vector<std::size_t> bytes = bytes_by_array(film);
  return std::accumulate(bytes.begin(), bytes.end(), std::size_t{0});
}

std::uint64_t bytes_of_film(const Film& like, std::uint64_t pixels) {
  std::uint64_t sum = 0;
  for (const std::size_t bytes : bytes_by_array(like)) sum += bytes_in_large_pages(bytes * pixels);
  return sum;
}

std::string samples_text(double samples_per_pixel) {
  return fmt::format("{:.{}f}", samples_per_pixel,
                     samples_per_pixel == std::floor(samples_per_pixel) ? 0 : 1);
}

Metadata describe(const Film& film) {
  // What the scene is, and what pilots decided; all other items are flags.
  static constexpr std::string_view no_flags[] = {
      "scene",       "hash",         "view",     "sharing",           "light-paths",
      "differences", "light-choice", "suffixes", "light-path-number", "branches"};
  Metadata metadata;
  std::string& options = metadata["castray:options"];
  for (const std::string& item : items_of(film.key)) {
    const std::string name = item.substr(0, item.find('='));
    const std::string value(
        unescape_item(std::string_view(item).substr(std::min(name.size() + 1, item.size()))));
    const bool is_flag = std::find(std::begin(no_flags), std::end(no_flags), name) == std::end(no_flags);
    if (!is_flag || name == "seed") metadata["castray:" + name] = value;
    if (is_flag) options += (options.empty() ? "--" : " --") + name + " " + value;
    if (name == "clamp-indirect") metadata["castray:biased"] = item;
  }
  metadata["castray:spp"] = samples_text(film.samples_per_pixel());
  return metadata;
}

}  // namespace castray
