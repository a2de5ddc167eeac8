#pragma once

#include <chrono>
#include <string>

#include "castray/render.h"
#include "cli/render_flags.h"

namespace castray::cli {

/// Shows on stderr how far a render is: a bar that rewrites its line, or a line every few seconds.
class ProgressDisplay {
 public:
  explicit ProgressDisplay(ProgressMode mode);

  void update(const Progress& progress);

  /// A message on a line of its own.
  void tell(const std::string& message);

  /// Ends the bar's line.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;

  ProgressMode mode_;
  Clock::time_point begin_ = Clock::now();
  double next_ = 0;  ///< seconds after begin_ of the next output
  double first_fraction_ = -1;
  bool line_open_ = false;
};

}  // namespace castray::cli
