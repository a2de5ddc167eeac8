#include "castray/merge_films.h"

#include <fmt/format.h>

#include <algorithm>

#include "castray/error.h"

namespace castray {

namespace fs = std::filesystem;

namespace {

/// Samples of one film.
struct HeldRange {
  SampleRange range;
  const fs::path* file;
};

/// The films that show one window.
struct WindowFilms {
  Window window;
  const fs::path* file;  ///< one of them
  std::vector<HeldRange> held;
};

std::uint64_t end_of(const SampleRange& range) { return range.first + range.count; }

std::uint64_t area(const Window& w) {
  return static_cast<std::uint64_t>(w.width()) * static_cast<std::uint64_t>(w.height());
}

bool overlap(const Window& a, const Window& b) {
  return a.x0 < b.x1 && b.x0 < a.x1 && a.y0 < b.y1 && b.y0 < a.y1;
}

Window around(Window a, const Window& b) {
  a.x0 = std::min(a.x0, b.x0), a.y0 = std::min(a.y0, b.y0);
  a.x1 = std::max(a.x1, b.x1), a.y1 = std::max(a.y1, b.y1);
  return a;
}

[[noreturn]] void refuse(const fs::path& file, const fs::path& first, const std::string& why) {
  throw InputError({file.string()}, "cannot be merged with " + first.string() + ": " + why);
}

/// Disjoint ascending ranges, neighbours joined.
std::vector<SampleRange> joined(std::vector<SampleRange> ranges) {
  std::sort(ranges.begin(), ranges.end(), [](auto& a, auto& b) { return a.first < b.first; });
  std::vector<SampleRange> all;
  for (const SampleRange& range : ranges)
    if (!all.empty() && range.first <= end_of(all.back()))
      all.back().count = std::max(end_of(all.back()), end_of(range)) - all.back().first;
    else
      all.push_back(range);
  return all;
}

std::vector<SampleRange> ranges_of(const WindowFilms& films) {
  std::vector<SampleRange> ranges;
  for (const HeldRange& held : films.held) ranges.push_back(held.range);
  return joined(ranges);
}

/// The parts of `wanted` that are not in `have`. Both are disjoint and ascending.
std::vector<SampleRange> gaps(const std::vector<SampleRange>& wanted, const std::vector<SampleRange>& have) {
  std::vector<SampleRange> missing;
  for (const SampleRange& range : wanted) {
    std::uint64_t at = range.first;
    for (const SampleRange& there : have) {
      if (end_of(there) <= at || there.first >= end_of(range)) continue;
      if (there.first > at) missing.push_back({at, there.first - at});
      at = end_of(there);
    }
    if (at < end_of(range)) missing.push_back({at, end_of(range) - at});
  }
  return missing;
}

/// What the headers of all films say together.
class Census {
 public:
  explicit Census(const std::vector<fs::path>& files) : first_(read_film_header(files.front())) {
    for (const fs::path& file : files) add(file, files.front());
    for (WindowFilms& films : windows_) require_disjoint(films);
    for (std::size_t i = 0; i < windows_.size(); ++i)
      for (std::size_t j = 0; j < i; ++j)
        if (overlap(windows_[i].window, windows_[j].window))
          refuse(*windows_[i].file, *windows_[j].file,
                 "their windows overlap; render disjoint --crop windows");
  }

  const Film& first() const { return first_; }
  const std::optional<SampleRange>& planned() const { return planned_; }

  Window window() const {
    Window all = windows_.front().window;
    for (const WindowFilms& films : windows_) all = around(all, films.window);
    return all;
  }

  /// All ranges that any window has.
  std::vector<SampleRange> samples() const {
    std::vector<SampleRange> ranges;
    for (const WindowFilms& films : windows_)
      for (const HeldRange& held : films.held) ranges.push_back(held.range);
    return joined(ranges);
  }

  std::vector<std::string> missing() const {
    std::vector<std::string> missing;
    const std::vector<SampleRange> wanted = planned_ ? std::vector{*planned_} : samples();
    std::uint64_t pixels = 0;
    for (const WindowFilms& films : windows_) {
      const Window& w = films.window;
      const std::string where =
          windows_.size() > 1 ? fmt::format(" of window {},{},{},{}", w.x0, w.y0, w.x1, w.y1) : "";
      for (const SampleRange& gap : gaps(wanted, ranges_of(films)))
        missing.push_back(fmt::format("samples {}:{}{}", gap.first, gap.count, where));
      pixels += area(w);
    }
    if (pixels < area(window()))
      missing.push_back(fmt::format("{} of {} pixels", area(window()) - pixels, area(window())));
    return missing;
  }

 private:
  void add(const fs::path& file, const fs::path& first) {
    const Film film = read_film_header(file);
    if (const std::string difference = film.difference_from(first_); !difference.empty())
      refuse(file, first, "the films are of different renders: " + difference);
    if (film.planned && planned_ && *film.planned != *planned_)
      refuse(file, first,
             fmt::format("they are parts of {} samples and of {}", film.planned->count, planned_->count));
    if (film.planned) planned_ = film.planned;
    auto films = std::find_if(windows_.begin(), windows_.end(),
                              [&](const WindowFilms& w) { return w.window == film.window(); });
    if (films == windows_.end()) films = windows_.insert(films, {film.window(), &file, {}});
    for (const SampleRange& range : film.samples) films->held.push_back({range, &file});
  }

  static void require_disjoint(WindowFilms& films) {
    auto& held = films.held;
    std::sort(held.begin(), held.end(), [](auto& a, auto& b) { return a.range.first < b.range.first; });
    for (std::size_t i = 1; i < held.size(); ++i)
      if (held[i].range.first < end_of(held[i - 1].range))
        refuse(*held[i].file, *held[i - 1].file,
               fmt::format("both films hold sample {}; render disjoint ranges with --samples FIRST:COUNT",
                           held[i].range.first));
  }

  Film first_;
  std::optional<SampleRange> planned_;
  std::vector<WindowFilms> windows_;
};

void note_missing(std::vector<std::string>& missing, std::uint64_t samples, const fs::path& file) {
  if (samples > 0)
    missing.push_back(fmt::format("{} samples of {}, which was stopped early", samples, file.string()));
}

}  // namespace

MergedFilm merge_films(const std::vector<fs::path>& files, const std::function<void(std::size_t)>& progress) {
  const Census census(files);
  MergedFilm merged{census.first().without_samples(census.window()), census.missing()};
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Film part = read_film(files[i]);
    merged.film.add(part);
    if (part.planned) note_missing(merged.missing, part.missing_samples(), files[i]);
    if (progress) progress(i + 1);
  }
  merged.film.samples = census.samples();
  merged.film.planned = census.planned();
  return merged;
}

MergedRows::MergedRows(const std::vector<fs::path>& files) {
  const Census census(files);
  window_ = census.window();
  missing_ = census.missing();
  sum_ = census.first().without_samples({window_.full_width, window_.full_height, 0, 0, 1, 1});
  sum_.samples = census.samples();
  sum_.planned = census.planned();
  for (const fs::path& file : files) {
    const Film header = read_film_header(file);
    if (header.keeps_replicates())
      throw InputError({file.string()},
                       "keeps replicates, which are merged as a whole only; raise --memory-limit");
    check_film_file(file);
    if (header.planned) note_missing(missing_, missing_samples(file), file);
    parts_.push_back({file, header.window()});
  }
}

Film MergedRows::rows(int y0, int y1) const {
  Window window = window_;
  window.y0 = y0, window.y1 = y1;
  Film sum = sum_.without_samples(window);
  sum.samples = sum_.samples;
  for (const Part& part : parts_) {
    const int from = std::max(y0, part.window.y0), to = std::min(y1, part.window.y1);
    if (from < to) sum.add(read_film_rows(part.file, from, to));
  }
  return sum;
}

}  // namespace castray
