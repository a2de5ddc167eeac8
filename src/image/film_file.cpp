#include <zlib.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <ostream>

#include "castray/error.h"
#include "core/files.h"
#include "core/two_sum.h"
#include "image/formats.h"

namespace castray {

// A film file: the line "castray film 1", a line of JSON, then little-endian: per pixel of the window, top
// row first, red, green, blue, the pair (high, low) of doubles with high + low the sum and high its rounding;
// then per pixel the number of samples (32 bits); the same, with 64 bits, per block of each replicate; the
// sums of splats and the numbers of light paths (64 bits), per block after each replicate and per pixel at
// the end, if the header has "splats"; then the CRC-32 of all before. With differences the first line is
// "castray film 2", and before the CRC-32 are DifferenceSums::all_sums (64 bits each), then all_counts (32).

static_assert(std::endian::native == std::endian::little, "film files are written as memory holds them");

namespace {

constexpr std::string_view magic = "castray film 1\n", magic_of_differences = "castray film 2\n";
static_assert(magic.size() == magic_of_differences.size());
constexpr std::uint64_t max_side = 1 << 24;
using nlohmann::json;

/// Of bytes, behind others of which it is `before`.
std::uint32_t checksum(std::string_view bytes, std::uint32_t before = 0) {
  if (bytes.empty()) return before;  // whose place may be null, with which zlib begins anew
  return static_cast<std::uint32_t>(
      crc32_z(before, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// Passes bytes on, and knows the checksum of all so far.
class ChecksummedStream {
 public:
  explicit ChecksummedStream(std::ostream& out) : out_(out) {}

  void write(std::string_view bytes) {
    sum_ = castray::checksum(bytes, sum_);
    out_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  std::uint32_t checksum() const { return sum_; }

 private:
  std::ostream& out_;
  std::uint32_t sum_ = 0;
};

}  // namespace

struct FilmFile {
  static void write(const Film& film, std::ostream& stream) {
    json ranges = json::array(), replicates = json::array();
    for (const SampleRange& range : film.samples) ranges.push_back({range.first, range.count});
    for (const Film::Replicate& replicate : film.replicates_) replicates.push_back(replicate.index);
    const Window& w = film.window_;
    json header{{"window", {w.full_width, w.full_height, w.x0, w.y0, w.x1, w.y1}},
                {"scale", film.scale_},
                {"samples", ranges},
                {"replicates", replicates},
                {"key", film.key},
                {"nonfinite_samples", film.nonfinite_samples},
                {"version", film.version}};
    if (film.planned && film.samples != std::vector{*film.planned})
      header["planned"] = {film.planned->first, film.planned->count};
    if (film.keeps_splats()) header["splats"] = true;
    ChecksummedStream out(stream);
    out.write(film.differences_.kept() ? magic_of_differences : magic);
    out.write(header.dump(-1, ' ', true, json::error_handler_t::replace) + "\n");
    write_sums(out, film.sums_);
    write_values(out, film.counts_);
    for (const Film::Replicate& replicate : film.replicates_) {
      write_sums(out, replicate.sums);
      write_values(out, replicate.counts);
      write_sums(out, replicate.splats);
      write_values(out, replicate.light_paths);
    }
    write_sums(out, film.splats_);
    write_values(out, film.light_paths_);
    write_values(out, film.differences_.all_sums());
    write_values(out, film.differences_.all_counts());
    write_values(out, std::array{out.checksum()});
  }

  /// The head of `bytes`: the film without its sums, and where they begin.
  static Film parse_head(const std::string& name, std::string_view bytes, std::size_t& data_begin) {
    if (!bytes.starts_with(magic) && !bytes.starts_with(magic_of_differences))
      throw InputError({name}, "is not a film of castray (format 1 or 2)");
    const std::size_t header_end = bytes.find('\n', magic.size());
    if (header_end == std::string_view::npos) throw InputError({name}, "is truncated");
    data_begin = header_end + 1;
    try {
      Film film = parse_header(json::parse(bytes.substr(magic.size(), header_end - magic.size())));
      if (bytes.starts_with(magic_of_differences)) film.differences_ = DifferenceSums(0, 0, film.scale_);
      return film;
    } catch (const json::exception& error) {
      throw InputError({name}, std::string("has a corrupt header: ") + error.what());
    }
  }

  /// Rows y0 <= y < y1 of the full image, of a film without replicates.
  static Film read_rows(const std::filesystem::path& file, int y0, int y1) {
    const std::string head = read_head(file, magic.size(), '\n');
    std::size_t section = 0;
    Film film = parse_head(file.string(), head, section);
    const auto columns = static_cast<std::size_t>(film.width());
    const std::size_t pixels = columns * static_cast<std::size_t>(film.height());
    const std::size_t first = columns * static_cast<std::size_t>(y0 - film.window_.y0);
    const std::size_t count = columns * static_cast<std::size_t>(y1 - y0);
    film.window_.y0 = y0, film.window_.y1 = y1;
    std::ifstream in(file, std::ios::binary);
    const auto read = [&](auto& values, std::size_t per_pixel, std::size_t halves = 1) {
      const std::size_t bytes = per_pixel * sizeof values[0];
      values = std::remove_cvref_t<decltype(values)>(halves * per_pixel * count);
      for (std::size_t half = 0; half < halves; ++half, section += pixels * bytes) {
        in.seekg(static_cast<std::streamoff>(section + first * bytes));
        in.read(reinterpret_cast<char*>(values.data() + half * per_pixel * count),
                static_cast<std::streamsize>(count * bytes));
      }
    };
    read(film.sums_, 3);
    read(film.counts_, 1);
    if (film.keeps_splats()) read(film.splats_, 3), read(film.light_paths_, 1);
    if (film.differences_.kept()) {
      film.keep_differences();
      constexpr std::size_t terms = DifferenceSums::terms, channels = DifferenceSums::channels;
      read(film.differences_.all_sums(), terms * channels, DifferenceSums::halves);
      read(film.differences_.all_counts(), terms, DifferenceSums::halves);
    }
    if (!in) throw InputError({file.string()}, "is truncated");
    film.nonfinite_samples = 0;
    return film;
  }

  static std::uint64_t missing_samples(const std::filesystem::path& file) {
    const std::string head = read_head(file, magic.size(), '\n');
    std::size_t data_begin = 0;
    const Film film = parse_head(file.string(), head, data_begin);
    std::size_t left = static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
    std::ifstream in(file, std::ios::binary);
    in.seekg(static_cast<std::streamoff>(data_begin + left * 3 * sizeof(Film::Sum)));
    std::vector<std::uint32_t> counts(std::min(left, std::size_t{1} << 16));
    std::uint64_t counted = 0;
    for (; left > 0 && in; left -= counts.size()) {
      counts.resize(std::min(left, counts.size()));
      in.read(reinterpret_cast<char*>(counts.data()),
              static_cast<std::streamsize>(counts.size() * sizeof counts[0]));
      counted = std::accumulate(counts.begin(), counts.end(), counted);
    }
    if (!in) throw InputError({file.string()}, "is truncated");
    return film.missing_samples(counted);
  }

  static Film parse(const std::string& name, std::string_view bytes) {
    const auto fail = [&](const std::string& what) { throw InputError({name}, what); };
    std::size_t data_begin = 0;
    Film film = parse_head(name, bytes, data_begin);
    const std::string_view data = bytes.substr(data_begin);
    const auto pixels = static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(film.height());
    const Film::Blocks grid = film.blocks();
    const auto blocks =
        static_cast<std::size_t>(grid.x1 - grid.x0) * static_cast<std::size_t>(grid.y1 - grid.y0);
    constexpr std::size_t colour_bytes = 3 * sizeof(Film::Sum);
    const std::size_t splat_bytes = film.keeps_splats() ? colour_bytes + 8 : 0;
    const std::size_t difference_bytes = film.differences_.kept() ? DifferenceSums::bytes_of_pixel : 0;
    const std::size_t length = pixels * (colour_bytes + 4 + splat_bytes + difference_bytes) +
                               film.replicates_.size() * blocks * (colour_bytes + 8 + splat_bytes) +
                               sizeof(std::uint32_t);
    if (data.size() != length) fail(data.size() < length ? "is truncated" : "has bytes behind its end");
    std::uint32_t stored;
    std::memcpy(&stored, data.data() + length - sizeof stored, sizeof stored);
    if (stored != checksum(bytes.substr(0, bytes.size() - sizeof stored)))
      fail("is corrupt: its checksum is wrong");
    const char* at = data.data();
    at = read_values(at, film.sums_, 3 * pixels);
    at = read_values(at, film.counts_, pixels);
    for (Film::Replicate& replicate : film.replicates_) {
      at = read_values(at, replicate.sums, 3 * blocks);
      at = read_values(at, replicate.counts, blocks);
      if (!film.keeps_splats()) continue;
      at = read_values(at, replicate.splats, 3 * blocks);
      at = read_values(at, replicate.light_paths, blocks);
    }
    if (film.keeps_splats()) {
      at = read_values(at, film.splats_, 3 * pixels);
      at = read_values(at, film.light_paths_, pixels);
    }
    if (film.differences_.kept()) film.keep_differences();
    DifferenceSums& differences = film.differences_;
    at = read_values(at, differences.all_sums(), differences.all_sums().size());
    read_values(at, differences.all_counts(), differences.all_counts().size());
    return film;
  }

 private:
  template <class Values>
  static void write_values(ChecksummedStream& out, const Values& values) {
    out.write({reinterpret_cast<const char*>(values.data()), values.size() * sizeof values[0]});
  }

  /// Some at a time: memory has no room for all of them twice.
  template <class Sums>
  static void write_sums(ChecksummedStream& out, const Sums& sums) {
    constexpr std::size_t at_a_time = 4096;
    std::vector<double> pairs;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      ExactSum<double> rounded;
      two_sum(sums[i].high, sums[i].low, rounded);
      pairs.insert(pairs.end(), {rounded.sum, rounded.error});
      if (pairs.size() < at_a_time && i + 1 < sums.size()) continue;
      write_values(out, pairs);
      pairs.clear();
    }
  }

  template <class Values>
  static const char* read_values(const char* at, Values& values, std::size_t count) {
    if (values.size() != count) values = Values(count);
    if (count > 0) std::memcpy(values.data(), at, count * sizeof values[0]);
    return at + count * sizeof values[0];
  }

  static void demand(bool good, const char* what) {
    if (!good) throw json::other_error::create(500, what, nullptr);
  }

  /// A whole number up to `most`: json's own conversion cuts what does not fit.
  static std::uint64_t whole(const json& value, std::uint64_t most = ~std::uint64_t{0}) {
    demand(value.is_number_unsigned() && value.get<std::uint64_t>() <= most, "bad number");
    return value.get<std::uint64_t>();
  }

  static SampleRange range_of(const json& item) {
    const SampleRange range{whole(item.at(0)), whole(item.at(1))};
    demand(range.count > 0 && range.first + range.count > range.first, "bad sample ranges");
    return range;
  }

  /// A film without its sums. Throws json::exception also where a value is out of range.
  static Film parse_header(const json& header) {
    Film film;
    const json& sides = header.at("window");
    const auto side = [&](std::size_t i) { return static_cast<int>(whole(sides.at(i), max_side)); };
    Window& w = film.window_;
    w = {side(0), side(1), side(2), side(3), side(4), side(5)};
    demand(w.x0 < w.x1 && w.x1 <= w.full_width, "bad window");
    demand(w.y0 < w.y1 && w.y1 <= w.full_height, "bad window");
    film.scale_ = header.at("scale").get<double>();
    demand(film.scale_ > 0 && std::isfinite(film.scale_), "bad scale");
    film.key = header.at("key").get<std::string>();
    film.nonfinite_samples = whole(header.at("nonfinite_samples"));
    film.version = header.at("version").get<std::string>();
    for (const json& index : header.at("replicates")) {
      film.replicates_.push_back({whole(index), {}, {}, {}, {}});
      const std::size_t n = film.replicates_.size();
      demand(n == 1 || film.replicates_[n - 2].index < film.replicates_[n - 1].index, "bad replicates");
    }
    if (header.contains("splats")) film.splats_.resize(1);  // kept: their number follows from the window
    std::uint64_t end = 0;
    for (const json& item : header.at("samples")) {
      const SampleRange range = range_of(item);
      demand(range.first >= end, "bad sample ranges");
      film.samples.push_back(range);
      end = range.first + range.count;
    }
    if (header.contains("planned")) film.planned = range_of(header["planned"]);
    return film;
  }
};

Film parse_film(const std::string& name, std::string_view bytes) { return FilmFile::parse(name, bytes); }

Film read_film(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  return parse_film(file.string(), bytes);
}

Film read_film_rows(const std::filesystem::path& file, int y0, int y1) {
  return FilmFile::read_rows(file, y0, y1);
}

std::uint64_t missing_samples(const std::filesystem::path& file) { return FilmFile::missing_samples(file); }

void check_film_file(const std::filesystem::path& file) {
  read_film_header(file);
  std::uint32_t stored = 0;
  std::uintmax_t left = std::filesystem::file_size(file) - sizeof stored;
  std::ifstream in(file, std::ios::binary);
  std::vector<char> block(std::size_t{1} << 20);
  uLong sum = crc32_z(0, nullptr, 0);
  while (left > 0 && in) {
    const auto count = static_cast<std::size_t>(std::min<std::uintmax_t>(left, block.size()));
    in.read(block.data(), static_cast<std::streamsize>(count));
    sum = crc32_z(sum, reinterpret_cast<const unsigned char*>(block.data()), count);
    left -= count;
  }
  in.read(reinterpret_cast<char*>(&stored), sizeof stored);
  if (!in || stored != sum)
    throw InputError({file.string()}, "is truncated or corrupt: its checksum is wrong");
}

Film read_film_header(const std::filesystem::path& file) {
  const std::string head = read_head(file, magic.size(), '\n');
  std::size_t data_begin = 0;
  return FilmFile::parse_head(file.string(), head, data_begin);
}

void write_film(const std::vector<std::filesystem::path>& files, const Film& film, const Display& display,
                const Metadata& metadata, int threads, const Passes& passes) {
  std::optional<Image> image;
  const auto write = [&](const std::filesystem::path& file) {
    if (is_film_format(file)) return write_file(file, [&](std::ostream& out) { FilmFile::write(film, out); });
    if (!image) image = image_of(film, threads);
    write_image(file, *image, display, metadata, noise_of(film), passes);
  };
  std::optional<InputError> failed;
  for (const auto& file : files) {
    try {
      write(file);
    } catch (const InputError& error) {
      if (!failed) failed = error;
    }
  }
  if (failed) throw *failed;
}

void write_film(const std::filesystem::path& file, const Film& film, const Display& display,
                const Metadata& metadata) {
  write_film(std::vector{file}, film, display, metadata);
}

void write_checkpoint(const std::filesystem::path& file, const Film& film) {
  write_file_keeping(file, previous_checkpoint(file), [&](std::ostream& out) { FilmFile::write(film, out); });
}

std::filesystem::path previous_checkpoint(const std::filesystem::path& file) {
  std::filesystem::path previous = file;
  return previous.replace_extension(".previous" + file.extension().string());
}

}  // namespace castray
