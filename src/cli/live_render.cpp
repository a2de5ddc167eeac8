#include "cli/live_render.h"

#include <algorithm>
#include <cmath>

#include "plan/job.h"

namespace castray::cli {

namespace {

/// The first picture of a view shall be there after so long; it has fewer pixels where that takes longer.
constexpr double seconds_of_first_picture = 0.06;
/// Without a request in this time nobody is looking.
constexpr std::chrono::seconds longest_silence{30};

RenderOptions live(RenderOptions options) {
  options.whole_passes = false;  // another view does not wait for the end of a pass
  return options;
}

}  // namespace

LiveRender::LiveRender(const Scene& scene, const RenderOptions& options)
    : scene_(scene), options_(live(options)), prepared_(scene, options_) {
  const Window window = window_of(scene.width, scene.height, options_);
  width_ = window.full_width, height_ = window.full_height;
  wish_.camera = scene.camera;
  thread_ = std::jthread([this](const std::stop_token& stop) {
    try {
      run(stop);
    } catch (const std::exception& error) {
      const std::lock_guard lock(mutex_);
      error_ = error.what();
      changed_.notify_all();
    }
  });
}

LiveRender::~LiveRender() = default;

void LiveRender::look(const Camera& camera) {
  const std::lock_guard lock(mutex_);
  wish_ = {camera, std::nullopt, wish_.views + 1, wish_.changes + 1};
  changed_.notify_all();
}

void LiveRender::refine(const std::optional<Window>& part) {
  const std::lock_guard lock(mutex_);
  wish_.part = part;
  ++wish_.changes;
  changed_.notify_all();
}

void LiveRender::pause(bool paused) {
  const std::lock_guard lock(mutex_);
  paused_ = paused;
  changed_.notify_all();
}

bool LiveRender::paused() const {
  const std::lock_guard lock(mutex_);
  return paused_;
}

std::string LiveRender::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

void LiveRender::stop() {
  thread_.request_stop();
  const std::lock_guard lock(mutex_);
  changed_.notify_all();
}

std::shared_ptr<const LiveFrame> LiveRender::frame_after(std::uint64_t number,
                                                         std::chrono::duration<double> patience) {
  std::unique_lock lock(mutex_);
  asked_ = Clock::now();
  changed_.notify_all();
  const auto is_there = [&] {
    return (frame_ && frame_->number > number) || !error_.empty() ||
           thread_.get_stop_token().stop_requested();
  };
  changed_.wait_for(lock, patience, is_there);
  asked_ = Clock::now();
  return frame_ && frame_->number > number ? frame_ : nullptr;
}

void LiveRender::run(const std::stop_token& stop) {
  Wish rendered;
  rendered.changes = ~std::uint64_t{0};
  while (!stop.stop_requested()) {
    Wish wish;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, stop, [&] { return wish_.changes != rendered.changes; });
      if (stop.stop_requested()) return;
      wish = wish_;
    }
    shown_ = false;
    if (!whole_ || wish.views != rendered.views) {
      whole_.reset();
      render_coarsely(stop, wish);
    }
    rendered = wish;
    render_wish(stop, wish);
  }
}

void LiveRender::render_wish(const std::stop_token& stop, const Wish& wish) {
  RenderOptions options = options_;
  options.camera = wish.camera;
  options.crop = wish.part;
  const std::optional<Film> start =
      wish.part && whole_ ? whole_->part(window_of(width_, height_, options)) : whole_;
  pass_begin_ = Clock::now();
  paths_before_ = 0;
  RenderResult result = render(
      prepared_, options, [&](const Progress& progress) { return goes_on(stop, wish, progress); },
      start ? &*start : nullptr);
  if (result.stats.stopped == Stopped::done) show(wish, result.film, true);
  if (!wish.part) whole_ = std::move(result.film);
}

/// Any picture of the view, soon.
void LiveRender::render_coarsely(const std::stop_token& stop, const Wish& wish) {
  const int step = coarse_step();
  if (step == 1) return;
  RenderOptions options = options_;
  options.camera = wish.camera;
  options.width = std::max(width_ / step, 1), options.height = std::max(height_ / step, 1);
  options.spp = 1;
  const RenderResult result = render(prepared_, options, [&](const Progress&) {
    const std::lock_guard lock(mutex_);
    return !stop.stop_requested() && wish_.views == wish.views;
  });
  if (result.stats.stopped == Stopped::done) show(wish, result.film, false);
}

int LiveRender::coarse_step() const {
  constexpr double first_guess = 1e-6;
  const double per_sample = seconds_per_sample_ > 0 ? seconds_per_sample_ : first_guess;
  const double seconds = per_sample * width_ * height_;
  constexpr double coarsest = 16;
  return static_cast<int>(
      std::clamp(std::ceil(std::sqrt(seconds / seconds_of_first_picture)), 1.0, coarsest));
}

bool LiveRender::rests() const { return (paused_ && shown_) || Clock::now() - asked_ > longest_silence; }

/// Another view is turned to at once; a part is refined from the end of the pass on, with what the film has.
bool LiveRender::goes_on(const std::stop_token& stop, const Wish& wish, const Progress& progress) {
  if (progress.film) {
    const Clock::time_point now = Clock::now();
    if (progress.paths > paths_before_)
      seconds_per_sample_ = std::chrono::duration<double>(now - pass_begin_).count() /
                            static_cast<double>(progress.paths - paths_before_);
    show(wish, *progress.film, false);
    paths_before_ = progress.paths;
  }
  std::unique_lock lock(mutex_);
  changed_.wait(lock, stop, [&] { return !rests() || wish_.changes != wish.changes; });
  if (progress.film) pass_begin_ = Clock::now();
  if (stop.stop_requested() || wish_.views != wish.views) return false;
  return !progress.film || wish_.changes == wish.changes;
}

void LiveRender::show(const Wish& wish, const Film& film, bool done) {
  auto frame = std::make_shared<LiveFrame>();
  frame->image = picture_of(wish, film);
  frame->width = width_, frame->height = height_;
  frame->spp = film.samples_per_pixel();
  frame->samples_per_second = seconds_per_sample_ > 0 ? 1 / seconds_per_sample_ : 0;
  frame->camera = wish.camera;
  frame->refined = wish.part;
  frame->done = done;
  frame->metadata = describe(film);
  shown_ = true;
  const std::lock_guard lock(mutex_);
  frame->number = frame_ ? frame_->number + 1 : 1;
  frame_ = std::move(frame);
  changed_.notify_all();
}

/// That of the whole view, in which the part stands that is refined.
Image LiveRender::picture_of(const Wish& wish, const Film& film) {
  Image image = image_of(film, options_.threads);
  if (!wish.part) return whole_image_ = std::move(image);
  Image picture = whole_image_;
  const Window& part = film.window();
  for (int y = part.y0; y < part.y1; ++y)
    std::copy_n(&image.at(0, y - part.y0), part.width(), &picture.at(part.x0, y));
  return picture;
}

}  // namespace castray::cli
