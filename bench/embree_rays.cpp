// The same as bench/rays.cpp with Embree in castray's place: the rival to measure against.

#include <embree3/rtcore.h>
#include <fmt/core.h>

#include <atomic>
#include <memory>
#include <type_traits>

#include "cli/tool_main.h"
#include "ray_bench.h"

namespace castray {
namespace {

struct Options : RayBenchOptions {
  std::string quality = "medium";
  bool robust = false;
};

using Device = std::unique_ptr<std::remove_pointer_t<RTCDevice>, decltype(&rtcReleaseDevice)>;
using Scene = std::unique_ptr<std::remove_pointer_t<RTCScene>, decltype(&rtcReleaseScene)>;

Device make_device(int threads) {
  return {rtcNewDevice(fmt::format("threads={},user_threads={}", threads, threads).c_str()),
          rtcReleaseDevice};
}

Scene make_scene(RTCDevice device, const std::vector<float>& soup, const Options& options) {
  Scene scene(rtcNewScene(device), rtcReleaseScene);
  if (options.robust) rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), options.quality == "low"    ? RTC_BUILD_QUALITY_LOW
                                       : options.quality == "high" ? RTC_BUILD_QUALITY_HIGH
                                                                   : RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  const std::size_t vertices = soup.size() / 3;
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices));
  std::copy(soup.begin(), soup.end(), positions);
  auto* indices = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), vertices / 3));
  for (std::uint32_t i = 0; i < vertices; ++i) indices[i] = i;
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(scene.get(), mesh);
  rtcReleaseGeometry(mesh);
  return scene;
}

RTCRay ray_at(const RayArrays& rays, std::size_t i) {
  const Ray<float> ray = rays[i];
  const auto &o = ray.origin, &d = ray.direction;
  return {o.x, o.y, o.z, 0, d.x, d.y, d.z, 0, ray.t_max, ~0u, 0, 0};
}

void trace(RTCScene scene, const RayArrays& rays, bool any, std::size_t first, std::size_t last,
           RayResult* out) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (std::size_t i = first; i < last; ++i) {
    if (any) {
      RTCRay ray = ray_at(rays, i);
      rtcOccluded1(scene, &context, &ray);
      out[i] = any_result(ray.tfar < 0);
    } else {
      RTCRayHit hit{};
      hit.ray = ray_at(rays, i);
      hit.hit.geomID = hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &hit);
      const bool found = hit.hit.geomID != RTC_INVALID_GEOMETRY_ID;
      out[i] = found ? RayResult{hit.ray.tfar, hit.hit.primID} : RayResult{};
    }
  }
}

/// A scene of instances of `mesh`, which is committed first.
Scene make_instances(RTCDevice device, RTCScene mesh, const std::vector<Transform>& places,
                     const Options& options) {
  Scene scene(rtcNewScene(device), rtcReleaseScene);
  if (options.robust) rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  for (const Transform& place : places) {
    RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh);
    float matrix[12];
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 4; ++column)
        matrix[4 * row + column] =
            static_cast<float>(column < 3 ? place.rows[row][column] : place.translation[row]);
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, matrix);
    rtcCommitGeometry(instance);
    rtcAttachGeometry(scene.get(), instance);
    rtcReleaseGeometry(instance);
  }
  return scene;
}

/// The mesh, or all that shows it.
struct Rival {
  Device device;
  Scene mesh;
  Scene instances{nullptr, rtcReleaseScene};

  Rival(int threads, const std::vector<float>& soup, const Options& options)
      : device(make_device(threads)), mesh(make_scene(device.get(), soup, options)) {
    if (!options.places.empty())
      instances = make_instances(device.get(), mesh.get(), read_places(options.places), options);
  }
  void commit() const {
    rtcCommitScene(mesh.get());
    if (instances) rtcCommitScene(instances.get());
  }
  RTCScene scene() const { return instances ? instances.get() : mesh.get(); }
};

bool count_bytes(void* held, ssize_t bytes, bool) {
  *static_cast<std::atomic<std::int64_t>*>(held) += bytes;
  return true;
}

/// Of the build alone, the copy of the mesh left out.
BuildCost build(int threads, const std::vector<float>& soup, const Options& options) {
  const Rival rival(threads, soup, options);
  std::atomic<std::int64_t> held = 0;
  rtcSetDeviceMemoryMonitorFunction(rival.device.get(), count_bytes, &held);
  const BuildCost cost = timed_build([&] {
    rival.commit();
    return static_cast<std::size_t>(held);
  });
  rtcSetDeviceMemoryMonitorFunction(rival.device.get(), nullptr, nullptr);
  return cost;
}

void measure(const Options& options) {
  const std::vector<float> soup = read_floats(options.mesh, 9);
  measure_build(options, soup.size() / 9, [&](int threads) { return build(threads, soup, options); });
  const Rival rival(options.threads, soup, options);
  rival.commit();
  fmt::print("{} triangles, Embree {}, quality {}, {} threads\n", soup.size() / 9,
             options.robust ? "robust" : "fast", options.quality, options.threads);
  measure_rays(options, [&](const RayArrays& rays, bool any, std::size_t first, std::size_t last,
                            RayResult* results) { trace(rival.scene(), rays, any, first, last, results); });
}

int run(int argc, char** argv) {
  Options options;
  CLI::App app{"Embree's rays per second on the meshes and rays of files.", "castray-embree-rays"};
  add_ray_bench_options(app, options);
  app.add_flag("--robust", options.robust);
  app.add_option("--quality", options.quality)
      ->check(CLI::IsMember({"low", "medium", "high"}))
      ->capture_default_str();
  return tool_main(app, argc, argv, [&] {
    measure(options);
    return 0;
  });
}

}  // namespace
}  // namespace castray

int main(int argc, char** argv) { return castray::run(argc, argv); }
