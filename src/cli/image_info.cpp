#include "cli/image_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "castray/film.h"
#include "core/text.h"

namespace castray::cli {

namespace {

/// Least, mean and greatest of each channel, over the finite pixels.
void print_range(const Image& image) {
  constexpr const char* names[] = {"red", "green", "blue"};
  for (int c = 0; c < 3; ++c) {
    double least = 0, greatest = 0, sum = 0;
    std::size_t count = 0;
    for (const Vec3f& v : image.pixels) {
      if (!is_finite(v)) continue;
      least = count ? std::min<double>(least, v[c]) : v[c];
      greatest = count ? std::max<double>(greatest, v[c]) : v[c];
      sum += v[c];
      ++count;
    }
    if (count)
      fmt::print("{:<10} {:.6g} .. {:.6g}, mean {:.6g}\n", names[c], least, greatest,
                 sum / static_cast<double>(count));
  }
  if (const std::size_t bad = count_nonfinite(image))
    fmt::print("warning    {} pixels are not finite\n", bad);
}

void print_alpha(const std::vector<float>& alpha) {
  const auto [least, greatest] = std::minmax_element(alpha.begin(), alpha.end());
  const double sum = std::accumulate(alpha.begin(), alpha.end(), 0.0);
  fmt::print("{:<10} {:.6g} .. {:.6g}, mean {:.6g}\n", "alpha", *least, *greatest,
             sum / static_cast<double>(alpha.size()));
}

void print_film(const std::filesystem::path& file) {
  const Film film = read_film(file);
  const Window& w = film.window();
  fmt::print("window     {},{},{},{} of {} x {}\n", w.x0, w.y0, w.x1, w.y1, w.full_width, w.full_height);
  if (const std::size_t replicates = film.replicate_means({}).size())
    fmt::print("replicates {}, of samples {}:{} and so on; tells its noise\n", replicates,
               film.samples.front().first, film.samples.front().count);
  else
    for (const SampleRange& range : film.samples) fmt::print("samples    {}:{}\n", range.first, range.count);
  if (film.differences().kept()) fmt::print("image of   means and differences of pixels (--reconstruct)\n");
  if (film.nonfinite_samples) fmt::print("warning    {} samples were not finite\n", film.nonfinite_samples);
}

}  // namespace

void print_image_info(const std::filesystem::path& path) {
  const ImageFile file = read_image(path);
  fmt::print("image      {}\n", path.string());
  fmt::print("size       {} x {}\n", file.image.width, file.image.height);
  fmt::print("values     {}\n", file.encoded ? "encoded, in 0 .. 1" : "linear radiance");
  print_range(file.image);
  if (!file.alpha.empty()) print_alpha(file.alpha);
  for (const std::string& other : file.left_out) fmt::print("also       {}\n", other);
  if (is_film_format(path))
    print_film(path);
  else if (file.noise)
    fmt::print("noise      told by a variance of each value, of {} degrees of freedom\n",
               file.noise->freedom);
  for (const auto& [key, value] : file.metadata)
    fmt::print("{:<10} {}\n", printable(key), printable(value, 4096));
}

}  // namespace castray::cli
