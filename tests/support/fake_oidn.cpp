// A library with the C interface of Open Image Denoise, as its documentation tells it, for tests where the
// real one is not installed. It checks how it is called; its "denoised" image is color + 2 albedo + 4 normal.
// With FAKE_OIDN_ERROR in the environment it reports that as the error of a filter that is run.
#include <cstddef>
#include <cstdlib>
#include <map>
#include <string>

namespace {

constexpr int device_cpu = 1, float3 = 3, error_invalid_argument = 2, error_invalid_operation = 3;

struct Device {
  bool committed = false;
  int error = 0;
  std::string message;
};

struct Plane {
  float* values = nullptr;
  std::size_t width = 0, height = 0;
};

struct Filter {
  Device* device = nullptr;
  std::map<std::string, Plane> images{};
  bool hdr = false, committed = false;
};

int living = 0;  // devices and filters

void fail(Device& device, int error, const std::string& message) {
  if (device.error == 0) device.error = error, device.message = message;
}

}  // namespace

extern "C" {

void* oidnNewDevice(int type) {
  if (type != device_cpu) return nullptr;
  ++living;
  return new Device;
}
void oidnCommitDevice(void* device) { static_cast<Device*>(device)->committed = true; }
void oidnReleaseDevice(void* device) {
  delete static_cast<Device*>(device);
  if (--living != 0) std::abort();  // a filter outlives it
}
int oidnGetDeviceInt(void*, const char* name) {
  const std::map<std::string, int> numbers{{"versionMajor", 9}, {"versionMinor", 8}, {"versionPatch", 7}};
  return numbers.at(name);
}
int oidnGetDeviceError(void* handle, const char** message) {
  static std::string told;
  Device& device = *static_cast<Device*>(handle);
  const int error = device.error;
  told = device.message;
  *message = told.c_str();
  device.error = 0;
  return error;
}

void* oidnNewFilter(void* handle, const char* type) {
  auto* device = static_cast<Device*>(handle);
  if (!device->committed) fail(*device, error_invalid_operation, "the device is not committed");
  if (type != std::string("RT")) fail(*device, error_invalid_argument, "unknown filter");
  ++living;
  return new Filter{device};
}
void oidnReleaseFilter(void* filter) {
  --living;
  delete static_cast<Filter*>(filter);
}
void oidnSetSharedFilterImage(void* handle, const char* name, void* values, int format, std::size_t width,
                              std::size_t height, std::size_t offset, std::size_t pixel_stride,
                              std::size_t row_stride) {
  auto& filter = *static_cast<Filter*>(handle);
  if (format != float3 || offset != 0 || pixel_stride != 0 || row_stride != 0)
    fail(*filter.device, error_invalid_argument, "the image's layout is another one");
  filter.images[name] = {static_cast<float*>(values), width, height};
  filter.committed = false;
}
void oidnSetFilterBool(void* handle, const char* name, bool value) {
  auto& filter = *static_cast<Filter*>(handle);
  if (name == std::string("hdr")) filter.hdr = value;
  filter.committed = false;
}
void oidnCommitFilter(void* handle) {
  auto& filter = *static_cast<Filter*>(handle);
  filter.committed = true;
  const Plane& output = filter.images["output"];
  for (const auto& [name, image] : filter.images)
    if (image.width != output.width || image.height != output.height)
      fail(*filter.device, error_invalid_argument, "images are not of one size");
  if (filter.images.contains("normal") && !filter.images.contains("albedo"))
    fail(*filter.device, error_invalid_operation, "normals without albedo");
}
void oidnExecuteFilter(void* handle) {
  auto& filter = *static_cast<Filter*>(handle);
  if (const char* error = std::getenv("FAKE_OIDN_ERROR"))
    return fail(*filter.device, error_invalid_operation, error);
  if (!filter.committed) return fail(*filter.device, error_invalid_operation, "the filter is not committed");
  if (!filter.hdr) return fail(*filter.device, error_invalid_operation, "radiance is HDR");
  const Plane& output = filter.images.at("output");
  const auto at = [&](const char* name, std::size_t i) {
    const auto found = filter.images.find(name);
    return found == filter.images.end() ? 0.f : found->second.values[i];
  };
  for (std::size_t i = 0; i < 3 * output.width * output.height; ++i)
    output.values[i] = at("color", i) + 2 * at("albedo", i) + 4 * at("normal", i);
}
}
