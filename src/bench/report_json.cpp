#include <fmt/core.h>

#include <nlohmann/json.hpp>

#include "bench/ablation.h"
#include "bench/report.h"

namespace castray {

namespace {

using Json = nlohmann::ordered_json;

Json optional_number(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json run_json(const BenchRun& run) {
  Json json{{"seed", run.seed}, {"seconds", run.seconds}};
  if (run.process_seconds) json["process_seconds"] = *run.process_seconds;
  json.update({{"relmse", run.relmse}, {"mse", run.mse}, {"relmse_everywhere", run.relmse_everywhere}});
  return json;
}

Json point_json(const BenchPoint& point) {
  Json json{{"spp", point.spp},
            {"seconds", point.seconds},
            {"process_seconds", optional_number(point.process_seconds)},
            {"relmse", point.relmse},
            {"mse", point.mse},
            {"relmse_everywhere", point.relmse_everywhere},
            {"efficiency", point.efficiency},
            {"runs", Json::array()}};
  for (const BenchRun& run : point.runs) json["runs"].push_back(run_json(run));
  return json;
}

Json curve_json(const BenchCurve& curve) {
  Json json{{"name", curve.name}, {"kind", kind_name(curve.kind)}, {"detail", curve.detail}};
  if (!curve.failure.empty()) json["failure"] = curve.failure;
  json["points"] = Json::array();
  for (const BenchPoint& point : curve.points) json["points"].push_back(point_json(point));
  if (curve.fit) {
    json["fit"] = {{"slope", curve.fit->is_fitted ? nlohmann::ordered_json(-curve.fit->slope)
                                                  : nlohmann::ordered_json()},
                   {"relmse_at_1s", curve.fit->constant}};
    for (const double error : target_errors)
      json["seconds_to"][fmt::format("{:.0e}", error)] = optional_number(curve.fit->seconds_to(error));
  }
  if (const auto& equal = curve.equal_time)
    json["equal_time"] = {
        {"spp", equal->spp}, {"seconds", equal->seconds}, {"relmse", equal->relmse}, {"flip", equal->flip}};
  return json;
}

Json scene_json(const BenchScene& scene) {
  Json json{{"name", scene.name},
            {"file", scene.file},
            {"width", scene.width},
            {"height", scene.height},
            {"reference", {{"made_of", scene.reference}, {"relmse", scene.reference_noise}}},
            {"mask", scene.masked ? "emitters" : "none"},
            {"counted_share", scene.counted},
            {"equal_seconds", scene.equal_seconds},
            {"curves", Json::array()}};
  for (const BenchCurve& curve : scene.curves) json["curves"].push_back(curve_json(curve));
  for (const AblationRow& row : ablation_rows(scene))
    if (row.failure.empty())
      json["ablation"].push_back({{"name", row.name},
                                  {"detail", row.detail},
                                  {"seconds_ratio", row.seconds},
                                  {"relmse_ratio", row.relmse},
                                  {"efficiency_ratio", row.efficiency}});
  return json;
}

}  // namespace

std::string bench_json(const BenchReport& report) {
  Json json{{"version", report.version}, {"machine", report.machine}, {"command", report.command},
            {"threads", report.threads}, {"seeds", report.seeds},     {"scenes", Json::array()}};
  for (const BenchScene& scene : report.scenes) json["scenes"].push_back(scene_json(scene));
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace castray
