#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "castray/differences.h"
#include "castray/image.h"
#include "castray/large_allocator.h"
#include "castray/vec.h"

namespace castray {

/// The window x0 <= x < x1, y0 <= y < y1 of a full image of full_width x full_height pixels.
struct Window {
  int full_width = 0, full_height = 0;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

  int width() const { return x1 - x0; }
  int height() const { return y1 - y0; }
  friend bool operator==(const Window&, const Window&) = default;
};

/// Sample indices first <= i < first + count.
struct SampleRange {
  std::uint64_t first = 0, count = 0;
  friend bool operator==(const SampleRange&, const SampleRange&) = default;
};

/// Sequences are scrambled anew after this many sample indices: index i belongs to replicate i /
/// replicate_length. Replicates are independent of one another, so the spread of their means measures the
/// noise, which the spread of samples of one scramble does not.
inline constexpr std::uint64_t replicate_length = std::uint64_t{1} << 20;

/// Side in pixels of the blocks of the full image's grid, the smallest areas with a noise estimate: errors of
/// neighbouring pixels, which may share paths, are not independent.
inline constexpr int noise_block = 8;

/// The sum of the samples' radiance, and their number, of each pixel.
///
/// Sums do not depend on the order of `add` and `merge`. A sample is a float; below 2^-36 of `scale` it is
/// rounded to a multiple of 2^-60 scale. The sum is a pair of doubles, high + low, where low collects the
/// exact error of each addition to high (Knuth's two-sum). Both are exact while count * sum < 2^46 scale, so
/// that the pair, renormalised, is the correctly rounded exact sum: the same bytes for every order.
class Film {
 public:
  Film() = default;
  /// `brightest`: any bound of the radiance that the scene emits; its power of two is the scale of the
  /// rounding.
  Film(const Window& window, double brightest);

  const Window& window() const { return window_; }
  int width() const { return window_.width(); }
  int height() const { return window_.height(); }
  double scale() const { return scale_; }

  /// Adds one sample to pixel (x,y) of the full image. Different pixels may be added to by different threads.
  void add(int x, int y, const Vec3f& radiance);

  /// Starts to keep the sums that an image is reconstructed from, of a film without samples. All samples must
  /// then come as tiles.
  void keep_differences();
  const DifferenceSums& differences() const { return differences_; }

  /// Adds rows y0 <= y < y1 of one sample, or take, of tiles side by side, from left to right, y of the full
  /// image, to a film that keeps differences. With its last take a sample counts; a take that is not finite
  /// is black, if the last one is finite.
  void add(std::span<const TileSamples> tiles, int y0, int y1);

  /// Starts to keep splats: what paths from lights bring to the pixels that they happen to be seen in.
  void keep_splats();
  bool keeps_splats() const { return !splats_.empty(); }
  /// Adds a splat to pixel (x,y) of the full image: radiance, if there is one light path for each pixel of
  /// the full image. Like `add`, but it is no sample of the pixel.
  void add_splat(int x, int y, const Vec3f& radiance);
  /// So many light paths were traced for the splats.
  void add_light_paths(std::uint64_t count);
  std::uint64_t light_paths(int x, int y) const { return keeps_splats() ? light_paths_[index(x, y)] : 0; }

  /// The mean of the pixel's samples, with that of the splats, black where it has none. (x,y) in the full
  /// image.
  Vec3d mean(int x, int y) const;
  /// The part of `mean` that splats bring.
  Vec3d mean_of_splats(int x, int y) const;
  std::uint32_t count(int x, int y) const { return counts_[index(x, y)]; }

  /// The means, as an image of the window's size.
  Image image(int threads = 1) const;

  /// Starts to keep the sums of each replicate apart, per block. All samples so far must be of one replicate.
  void keep_replicates();
  bool keeps_replicates() const { return !replicates_.empty(); }

  /// A rectangle of blocks: column x0 <= x < x1, row y0 <= y < y1 of the full image's grid.
  struct Blocks {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  };
  /// All that a window meets.
  static Blocks blocks_of(const Window& window);
  Blocks blocks() const { return blocks_of(window_); }
  /// The mean radiance over some blocks in each replicate kept, by ascending replicate.
  std::vector<Vec3d> replicate_means(const Blocks& blocks) const;

  /// Adds the samples of `other`. Throws InputError that names what differs, and changes nothing, if the two
  /// are not parts of one render or if their sample ranges overlap.
  void merge(const Film& other);

  /// In what the two are not of one render, as "seed=0 against seed=4": items of `key`, `version`, the
  /// scene's brightness, whether replicates are kept. Empty if they are; their windows and samples may
  /// differ.
  std::string difference_from(const Film& other) const;

  /// A film of the same render, of another window, without samples.
  Film without_samples(const Window& window) const;

  /// The film of a part of the window, with its sums. Of a film between two passes; without replicates.
  Film part(const Window& window) const;

  /// Adds the sums of `other`, whose window lies in this one's, and which is of the same render and has no
  /// sample of a pixel that this film has. `samples` are left to the caller.
  void add(const Film& other);

  /// Samples taken, on average over the pixels, those that were not finite included.
  double samples_per_pixel() const;

  /// How many of `samples` its pixels lack: those of a render that was stopped within a pass.
  std::uint64_t missing_samples() const;

  /// All that the samples depend on besides their index (scene, seed, options), as "name=value" items
  /// separated by "; "; in a value '%', ';', '=' and control characters are written as "%XX".
  std::string key;
  std::string version;               ///< of the castray that rendered it
  std::vector<SampleRange> samples;  ///< rendered so far, ascending, disjoint, not adjacent
  /// The samples of the whole render of which this film is a part, if that is known.
  std::optional<SampleRange> planned;
  std::uint64_t nonfinite_samples = 0;

 private:
  struct Sum {
    double high = 0, low = 0;
    Sum& operator+=(const Sum& other);  ///< exact
    double value() const { return high + low; }
  };
  /// The sums of one replicate.
  struct Replicate {
    std::uint64_t index = 0;
    std::vector<Sum> sums;                   ///< 3 per block
    std::vector<std::uint64_t> counts;       ///< samples, per block
    std::vector<Sum> splats;                 ///< 3 per block, if splats are kept
    std::vector<std::uint64_t> light_paths;  ///< per block, the sum over its pixels
  };
  /// Adds radiance, rounded as above, to the sums of three channels.
  void add(Sum* sums, const Vec3f& radiance) const;
  void add(const Replicate& theirs, const Blocks& their_blocks);

  friend struct FilmFile;  // reads and writes the sums as they are

  /// Of what `samples` say of all pixels, those beyond `counted` and `nonfinite_samples`.
  std::uint64_t missing_samples(std::uint64_t counted) const;

  /// The mean of splats, from sums over pixels and the sum of their light paths.
  Vec3d splats_over_paths(const Vec3d& splats, double paths) const;

  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - window_.y0) * static_cast<std::size_t>(width()) +
           static_cast<std::size_t>(x - window_.x0);
  }

  Window window_;
  double scale_ = 1;
  LargeVector<Sum> sums_;  ///< 3 per pixel
  LargeVector<std::uint32_t> counts_;
  std::vector<Sum> splats_;  ///< 3 per pixel, or none
  std::vector<std::uint64_t>
      light_paths_;  ///< per pixel, as windows and samples of merged films differ; or none
  DifferenceSums differences_;
  std::vector<Replicate> replicates_;  ///< ascending
};

/// The film's image: reconstructed from means and differences if it keeps differences (docs/transport.md),
/// else its means. Reconstruction has the same mean and much less noise; it may make a dark pixel negative.
/// The same for any number of threads; 0: all that this process may use.
Image image_of(const Film& film, int threads = 0);

/// The memory, in bytes, of a film like this one of so many pixels, replicates left out.
std::uint64_t bytes_of_film(const Film& like, std::uint64_t pixels);

/// The memory, in bytes, that `image_of` and `write_film` take at most besides such a film of width x height
/// pixels: the image, what it is reconstructed from, and what writers of formats make of it.
std::uint64_t bytes_of_image(const Film& like, int width, int height, int threads);

/// The noise of the film's image, from its replicates; none if it keeps fewer than two. The pixels of a block
/// share the variance of the block's mean, times its pixels, times one factor of at least 1 for the whole
/// film: the most by which the variance of larger blocks exceeds, on average, what independent blocks would
/// have.
std::optional<Noise> noise_of(const Film& film);

/// What a film says of itself, as PNG and EXR files hold it: scene and its hash, seed, spp, and options as
/// flags of the command line.
Metadata describe(const Film& film);

/// A number of samples per pixel for people: whole, or with one decimal.
std::string samples_text(double samples_per_pixel);

/// Reads a .film file. Throws InputError if it is not one, is truncated or corrupt.
Film read_film(const std::filesystem::path& file);

/// Reads what a .film says of itself, without its sums: window, key, version, samples. The same errors, but
/// for what the sums would show.
Film read_film_header(const std::filesystem::path& file);

/// Reads rows y0 <= y < y1 of the full image, which lie in the window, of a film without replicates; how many
/// of its samples were not finite is not known of them. Throws InputError where they end early; the checksum
/// is that of `check_film_file`.
Film read_film_rows(const std::filesystem::path& file, int y0, int y1);

/// `Film::missing_samples` of a file of which a little at a time is in memory.
std::uint64_t missing_samples(const std::filesystem::path& file);

/// Throws InputError unless the checksum of the file, which is never in memory as a whole, is right.
void check_film_file(const std::filesystem::path& file);

/// Bytes of memory and of files for a pixel of films like this one, replicates left out.
std::size_t bytes_of_pixel(const Film& film);

/// Writes the film losslessly to .film files, and its image, made once, to others (see `write_image`); throws
/// InputError once all that can be is written. A .film's bytes depend on its samples and `key` alone, not on
/// the order of adding and merging. `threads`: as for `image_of`; `passes`: as for `write_image`.
void write_film(const std::vector<std::filesystem::path>& files, const Film& film,
                const Display& display = {}, const Metadata& metadata = {}, int threads = 0,
                const Passes& passes = {});
void write_film(const std::filesystem::path& file, const Film& film, const Display& display = {},
                const Metadata& metadata = {});

/// Writes a .film file; the one that was there is kept as `previous_checkpoint(file)`.
void write_checkpoint(const std::filesystem::path& file, const Film& film);
/// "a/x.previous.film" of "a/x.film".
std::filesystem::path previous_checkpoint(const std::filesystem::path& file);

}  // namespace castray
