#pragma once

#include <chrono>

#include "bench/measure.h"

namespace castray::cli {

/// Shows on stderr how far a benchmark is: one line rewritten on a terminal, else a line every few seconds.
class BenchMeter {
 public:
  explicit BenchMeter(bool quiet);
  void tell(const BenchProgress& progress);
  /// A part before the measurement, whose seconds left follow from the fraction done since it began.
  void tell_part(const std::string& what, double fraction);
  /// Ends the terminal's line.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  bool quiet_, terminal_;
  Clock::time_point last_, part_begin_;
  std::string part_;
};

}  // namespace castray::cli
