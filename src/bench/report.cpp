#include "bench/report.h"

namespace castray {

bool BenchScene::needs_better_references() const {
  constexpr double enough = 0.2;
  for (const BenchCurve& curve : curves)
    for (const BenchPoint& point : curve.points)
      if (point.relmse < enough * reference_noise) return true;
  return false;
}

std::string kind_name(ContenderKind kind) {
  switch (kind) {
    case ContenderKind::configuration:
      return "configuration";
    case ContenderKind::ablation:
      return "ablation";
    case ContenderKind::peer:
      return "peer";
  }
  return "";
}

}  // namespace castray
