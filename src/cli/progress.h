#pragma once

#include <chrono>
#include <string>

#include "castray/render.h"
#include "cli/progress_text.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// `mode`, or what suits stderr.
ProgressMode chosen_mode(ProgressMode mode);

/// Shows on stderr how far a render is: a bar that rewrites its line; lines, each after twice the time of the
/// one before; or JSON objects, two a second at most.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(ProgressMode mode);

  void update(const Progress& progress);

  /// A message on a line of its own.
  void tell(const std::string& message);

  /// The last state; that of a render that was not stopped is 100 %.
  void finish(bool complete);

 private:
  using Clock = std::chrono::steady_clock;

  double elapsed() const { return std::chrono::duration<double>(Clock::now() - begin_).count(); }
  void show();

  ProgressMode mode_;
  Clock::time_point begin_ = Clock::now();
  double next_ = 0;  ///< seconds after begin_ of the next output
  double first_fraction_ = -1;
  ProgressState state_;
  bool shown_ = false, line_open_ = false;
};

}  // namespace castray::cli
