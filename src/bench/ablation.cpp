#include "bench/ablation.h"

#include <algorithm>

namespace castray {

std::vector<AblationRow> ablation_rows(const BenchScene& scene) {
  const auto whole = std::find_if(scene.curves.begin(), scene.curves.end(), [](const BenchCurve& curve) {
    return curve.kind == ContenderKind::configuration && !curve.points.empty();
  });
  std::vector<AblationRow> rows;
  if (whole == scene.curves.end()) return rows;
  const BenchPoint& all = whole->points.back();
  for (const BenchCurve& curve : scene.curves) {
    if (curve.kind != ContenderKind::ablation) continue;
    AblationRow row{curve.name, curve.detail, curve.failure};
    if (!curve.points.empty()) {
      const BenchPoint& without = curve.points.back();
      row.seconds = without.seconds / all.seconds;
      row.relmse = without.relmse / all.relmse;
      row.efficiency = without.efficiency / all.efficiency;
    }
    rows.push_back(row);
  }
  return rows;
}

}  // namespace castray
