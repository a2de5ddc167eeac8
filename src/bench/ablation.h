#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/report.h"

namespace castray {

/// What leaving one technique out does, at the largest budget: ratios to the first configuration.
struct AblationRow {
  std::string name, detail, failure;
  double seconds = 1, relmse = 1, efficiency = 1;
};

/// One row an ablation; none if the scene has no configuration to compare with.
std::vector<AblationRow> ablation_rows(const BenchScene& scene);

}  // namespace castray
