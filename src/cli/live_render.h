#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "castray/render.h"
#include "castray/scene.h"

namespace castray::cli {

/// What a live render shows at some moment.
struct LiveFrame {
  std::uint64_t number = 0;   ///< counts up from 1
  Image image;                ///< of the whole view
  int width = 0, height = 0;  ///< of the view; `image` is smaller in the first moment of a view
  double spp = 0;             ///< samples per pixel, of the part that is refined if there is one
  double samples_per_second = 0;
  Camera camera;
  std::optional<Window> refined;
  bool done = false;  ///< has all its samples
  Metadata metadata;
};

/// Renders a scene in a thread of its own for people who look at it: on and on, from the start when they
/// turn to another view, and no more than a part of the image when they ask for it. All functions may be
/// called from any thread.
class LiveRender {
 public:
  /// Prepares the scene, which must outlive this object. Throws InputError.
  LiveRender(const Scene& scene, const RenderOptions& options);
  ~LiveRender();
  LiveRender(const LiveRender&) = delete;
  LiveRender& operator=(const LiveRender&) = delete;

  /// Starts anew with another view, of the whole image.
  void look(const Camera& camera);
  /// From the end of the pass on only this part of the image gets samples; without one, the whole.
  void refine(const std::optional<Window>& part);
  void pause(bool paused);
  bool paused() const;

  /// The last frame, if its number is above `number`, or the next one; null if none comes in this time. While
  /// nobody asks, the render rests.
  std::shared_ptr<const LiveFrame> frame_after(std::uint64_t number, std::chrono::duration<double> patience);

  /// What ended the render, if anything did.
  std::string error() const;

  /// Ends the render, and all waiting for frames.
  void stop();

 private:
  using Clock = std::chrono::steady_clock;
  struct Wish {
    Camera camera;
    std::optional<Window> part;
    std::uint64_t views = 0, changes = 0;  ///< so far
  };

  void run(const std::stop_token& stop);
  void render_wish(const std::stop_token& stop, const Wish& wish);
  void render_coarsely(const std::stop_token& stop, const Wish& wish);
  int coarse_step() const;
  bool goes_on(const std::stop_token& stop, const Wish& wish, const Progress& progress);
  bool rests() const;
  void show(const Wish& wish, const Film& film, bool done);
  Image picture_of(const Wish& wish, const Film& film);

  const Scene& scene_;
  RenderOptions options_;
  PreparedScene prepared_;
  int width_, height_;

  // of the thread
  std::optional<Film> whole_;  ///< of the present view, at the end of its last pass
  Image whole_image_;          ///< on which a refined part is shown
  double seconds_per_sample_ = 0;
  Clock::time_point pass_begin_;
  std::uint64_t paths_before_ = 0;
  bool shown_ = false;  ///< anything of the present wish

  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  Wish wish_;
  bool paused_ = false;
  Clock::time_point asked_ = Clock::now();
  std::shared_ptr<const LiveFrame> frame_;
  std::string error_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace castray::cli
