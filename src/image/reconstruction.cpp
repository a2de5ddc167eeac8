#include "image/reconstruction.h"

#include <algorithm>

#include "core/threads.h"

namespace castray {

namespace {

/// Of its errors, a pixel's mean shares most with its tile: how much its weight is less for that.
constexpr float weight_of_mean = 0.25f;
/// The least relative variance of a sample: less is not known of floats.
constexpr float least_noise = 1e-7f;
/// The most that a pair weighs more than a mean, so that corrections reach some hundred pixels and no
/// further.
constexpr float stiffest = 16384;

/// Pairs more noisy than this many times one of their pixels count nothing: they would tell little.
constexpr float noisiest = 4;

PixelPlanes planes(int width, int height) {
  return {PixelPlane(width, height), PixelPlane(width, height), PixelPlane(width, height)};
}

/// For corrections of the means of one half, as parts of the guide.
class Equations {
 public:
  PixelCouplings couplings;
  PixelPlanes b;

  Equations(const HalfFilm& data, const HalfFilm& other, int width, int height, int threads)
      : couplings(width, height), b(planes(width, height)), guide_(other.guide), threads_(threads) {
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        couplings.screen.row(y)[x] =
            weight_of_mean * data.count.row(y)[x] / std::max(other.noise.row(y)[x], least_noise);
    const PixelPlanes right = weigh(data.right, other.right.noise, other.noise, couplings.right, 1, 0);
    const PixelPlanes below = weigh(data.below, other.below.noise, other.noise, couplings.below, 0, 1);
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (int y = 0; y < height; ++y)
      for (std::size_t c = 0; c < 3; ++c) {
        const float *to_right = right[c].row(y), *down = below[c].row(y), *up = below[c].row(y - 1);
        float* sum = b[c].row(y);
        for (int x = 0; x < width; ++x) sum[x] = (to_right[x - 1] - to_right[x]) + (up[x] - down[x]);
      }
  }

 private:
  /// Fills in the weights of pairs, 0 where they are noisier than one of their pixels: at edges, which are
  /// left as they are. Returns, times the weights, how much more q is than p where both are in one tile than
  /// it is in all samples, both as parts of the guide.
  PixelPlanes weigh(const HalfFilm::Pairs& pairs, const PixelPlane& noise, const PixelPlane& pixel_noise,
                    PixelPlane& weights, int dx, int dy) const {
    const int w = couplings.width, h = couplings.height;
    PixelPlanes pulls = planes(w, h);
#pragma omp parallel for schedule(static) num_threads(threads_)
    for (int y = 0; y < h - dy; ++y) {
      const float *screen = couplings.screen.row(y), *count = pairs.count.row(y), *noisy = noise.row(y);
      float* weight = weights.row(y);
      const float *own = pixel_noise.row(y), *next = pixel_noise.row(y + dy) + dx;
      for (int x = 0; x < w - dx; ++x) {
        const float wanted = std::min(count[x] / std::max(noisy[x], least_noise), stiffest * screen[x]);
        weight[x] = noisy[x] <= noisiest * std::min(own[x], next[x]) ? wanted : 0;
      }
      for (std::size_t c = 0; c < 3; ++c) {
        const float *here = pairs.here[c].row(y), *there = pairs.there[c].row(y), *p = guide_[c].row(y),
                    *q = guide_[c].row(y + dy) + dx;
        float* pull = pulls[c].row(y);
        for (int x = 0; x < w - dx; ++x) pull[x] = weight[x] * (there[x] / q[x] - here[x] / p[x]);
      }
    }
    return pulls;
  }

  const PixelPlanes& guide_;
  int threads_;
};

}  // namespace

PixelPlanes corrections(const HalfFilm& data, const HalfFilm& other, int width, int height, int threads) {
  Equations e(data, other, width, height, threads);
  PixelPlanes result = solve_screened_poisson(std::move(e.couplings), std::move(e.b), threads);
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < height; ++y)
    for (std::size_t c = 0; c < 3; ++c) {
      const float* guide = other.guide[c].row(y);
      float* correction = result[c].row(y);
      for (int x = 0; x < width; ++x) correction[x] *= guide[x];
    }
  return result;
}

namespace {

/// Adds the corrections of one half to the image.
void correct(Image& image, const Film& film, const HalfFilm& data, const HalfFilm& other, int threads) {
  const PixelPlanes correction = corrections(data, other, film.width(), film.height(), threads);
  const Window& window = film.window();
#pragma omp parallel for schedule(static) num_threads(threads)
  for (int y = 0; y < film.height(); ++y) {
    const float *red = correction[0].row(y), *green = correction[1].row(y), *blue = correction[2].row(y),
                *count = data.count.row(y);
    for (int x = 0; x < film.width(); ++x) {
      const auto all = static_cast<float>(film.count(window.x0 + x, window.y0 + y));
      if (all > 0) image.at(x, y) += Vec3f(red[x], green[x], blue[x]) * (count[x] / all);
    }
  }
}

}  // namespace

Image image_of(const Film& film, int threads) {
  Image image = film.image();
  if (!film.differences().kept()) return image;
  if (threads <= 0) threads = available_threads();
  const HalfFilm even(film, 0, threads), odd(film, 1, threads);
  correct(image, film, even, odd, threads);
  correct(image, film, odd, even, threads);
  return image;
}

}  // namespace castray
