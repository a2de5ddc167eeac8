#include "castray/film.h"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "castray/error.h"
#include "core/text.h"
#include "core/two_sum.h"

namespace castray {

namespace {

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
  const ExactSum exact = two_sum(high, other.high);
  high = exact.sum;
  low += other.low + exact.error;
  return *this;
}

void Film::add(int x, int y, const Vec3f& radiance) {
  const std::size_t pixel = index(x, y);
  const double small = scale_ * 0x1p-36;
  const double rounder = scale_ * 0x1.8p-8;  // 1.5 * 2^52 quanta of 2^-60: adding it rounds to a quantum
  for (int c = 0; c < 3; ++c) {
    double v = radiance[c];
    if (std::abs(v) < small) v = (v + rounder) - rounder;
    Sum& s = sums_[3 * pixel + static_cast<std::size_t>(c)];
    const ExactSum next = two_sum(s.high, v);
    s.high = next.sum;
    s.low += next.error;
  }
  ++counts_[pixel];
}

Vec3d Film::mean(int x, int y) const {
  const std::size_t pixel = index(x, y);
  if (counts_[pixel] == 0) return {};
  const double n = counts_[pixel];
  const Sum* s = &sums_[3 * pixel];
  return Vec3d{s[0].high + s[0].low, s[1].high + s[1].low, s[2].high + s[2].low} / n;
}

Image Film::image() const {
  Image image(width(), height());
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
                      std::vector<Sum>(3 * columns * rows), std::vector<std::uint64_t>(columns * rows)};
  for (int y = window_.y0; y < window_.y1; ++y)
    for (int x = window_.x0; x < window_.x1; ++x) {
      const std::size_t block = static_cast<std::size_t>(y / noise_block - all.y0) * columns +
                                static_cast<std::size_t>(x / noise_block - all.x0);
      for (std::size_t c = 0; c < 3; ++c) replicate.sums[3 * block + c] += sums_[3 * index(x, y) + c];
      replicate.counts[block] += counts_[index(x, y)];
    }
  replicates_ = {std::move(replicate)};
}

std::vector<Vec3d> Film::replicate_means(const Blocks& wanted) const {
  const Blocks all = blocks();
  std::vector<Vec3d> means;
  for (const Replicate& replicate : replicates_) {
    Vec3d sum;
    double count = 0;
    for (int y = wanted.y0; y < wanted.y1; ++y)
      for (int x = wanted.x0; x < wanted.x1; ++x) {
        const std::size_t block =
            static_cast<std::size_t>(y - all.y0) * static_cast<std::size_t>(all.x1 - all.x0) +
            static_cast<std::size_t>(x - all.x0);
        const Sum* s = &replicate.sums[3 * block];
        sum += Vec3d{s[0].high + s[0].low, s[1].high + s[1].low, s[2].high + s[2].low};
        count += static_cast<double>(replicate.counts[block]);
      }
    means.push_back(count > 0 ? sum / count : Vec3d{});
  }
  return means;
}

void Film::require_same_render(const Film& other) const {
  if (key != other.key)
    throw InputError("the films are of different renders: " + difference_of_keys(key, other.key));
  if (version != other.version)
    throw InputError(
        fmt::format("the films are of different versions of castray: {} and {}", version, other.version));
  if (window_ != other.window_)
    throw InputError("the films show different windows: " + to_string(window_) + " and " +
                     to_string(other.window_));
  if (scale_ != other.scale_)
    throw InputError(
        fmt::format("the films are of scenes of different brightness: {} and {}", scale_, other.scale_));
  if (keeps_replicates() != other.keeps_replicates())
    throw InputError(
        "one film keeps replicates and the other does not; render both with --replicates, or none");
}

void Film::merge(const Film& other) {
  require_same_render(other);
  samples = joined_ranges(samples, other.samples);
  for (std::size_t i = 0; i < sums_.size(); ++i) sums_[i] += other.sums_[i];
  for (const Replicate& theirs : other.replicates_) {
    const auto ours = std::lower_bound(replicates_.begin(), replicates_.end(), theirs.index,
                                       [](const Replicate& r, std::uint64_t i) { return r.index < i; });
    if (ours == replicates_.end() || ours->index != theirs.index) {
      replicates_.insert(ours, theirs);
      continue;
    }
    for (std::size_t i = 0; i < ours->sums.size(); ++i) ours->sums[i] += theirs.sums[i];
    for (std::size_t i = 0; i < ours->counts.size(); ++i) ours->counts[i] += theirs.counts[i];
  }
  for (std::size_t i = 0; i < counts_.size(); ++i) counts_[i] += other.counts_[i];
  nonfinite_samples += other.nonfinite_samples;
}

double Film::samples_per_pixel() const {
  const std::uint64_t counted = std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
  return static_cast<double>(counted + nonfinite_samples) / static_cast<double>(counts_.size());
}

std::string samples_text(double samples_per_pixel) {
  return fmt::format("{:.{}f}", samples_per_pixel,
                     samples_per_pixel == std::floor(samples_per_pixel) ? 0 : 1);
}

Metadata describe(const Film& film) {
  Metadata metadata;
  std::string& options = metadata["castray:options"];
  for (const std::string& item : items_of(film.key)) {
    const std::string name = item.substr(0, item.find('='));
    const std::string value(
        unescape_item(std::string_view(item).substr(std::min(name.size() + 1, item.size()))));
    if (name == "scene" || name == "hash" || name == "seed" || name == "sharing")
      metadata["castray:" + name] = value;
    if (name != "scene" && name != "hash" && name != "sharing")
      options += (options.empty() ? "--" : " --") + name + " " + value;
    if (name == "clamp-indirect") metadata["castray:biased"] = item;
  }
  metadata["castray:spp"] = samples_text(film.samples_per_pixel());
  return metadata;
}

}  // namespace castray
