#include "castray/denoise.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <memory>

#include "castray/error.h"
#include "core/text.h"

namespace castray {

namespace {

// Values of the library's documentation.
constexpr int device_of_processor = 1, format_float3 = 3;

struct Close {
  void operator()(void* handle) const { dlclose(handle); }
};
using Handle = std::unique_ptr<void, Close>;

Handle open(const std::filesystem::path& library) {
  constexpr const char* usual[] = {"libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1"};
  if (!library.empty()) {
    if (Handle handle{dlopen(library.c_str(), RTLD_NOW | RTLD_LOCAL)}) return handle;
    throw InputError("CASTRAY_OIDN: cannot be loaded: " + printable(dlerror(), 400));
  }
  for (const char* name : usual)
    if (Handle handle{dlopen(name, RTLD_NOW | RTLD_LOCAL)}) return handle;
  throw InputError(
      "Open Image Denoise is not installed: put libOpenImageDenoise.so.2 of openimagedenoise.org where the "
      "system has "
      "its libraries, or set CASTRAY_OIDN to its path");
}

template <class Function>
void find(const Handle& handle, Function*& function, const char* name, const char* former = nullptr) {
  void* symbol = dlsym(handle.get(), name);
  if (!symbol && former) symbol = dlsym(handle.get(), former);
  if (!symbol) throw InputError(fmt::format("Open Image Denoise: this library has no {}", name));
  function = reinterpret_cast<Function*>(symbol);
}

}  // namespace

/// What is used of its C interface; some functions had other names in version 1.
struct Denoiser::Library {
  explicit Library(const std::filesystem::path& file) : handle(open(file)) {
    find(handle, new_device, "oidnNewDevice");
    find(handle, commit_device, "oidnCommitDevice");
    find(handle, release_device, "oidnReleaseDevice");
    find(handle, device_error, "oidnGetDeviceError");
    find(handle, device_int, "oidnGetDeviceInt", "oidnGetDevice1i");
    find(handle, new_filter, "oidnNewFilter");
    find(handle, release_filter, "oidnReleaseFilter");
    find(handle, set_image, "oidnSetSharedFilterImage");
    find(handle, set_bool, "oidnSetFilterBool", "oidnSetFilter1b");
    find(handle, commit_filter, "oidnCommitFilter");
    find(handle, execute, "oidnExecuteFilter");
    device = new_device(device_of_processor);
    if (device) commit_device(device);
    if (!device) throw InputError("Open Image Denoise: has no device for this processor");
    check();
  }
  ~Library() {
    if (device) release_device(device);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  void check() const {
    const char* message = nullptr;
    if (device_error(device, &message) != 0)
      throw InputError("Open Image Denoise: " + printable(message ? message : "failed", 400));
  }

  Handle handle;
  void* (*new_device)(int type) = nullptr;
  void (*commit_device)(void* device) = nullptr;
  void (*release_device)(void* device) = nullptr;
  int (*device_error)(void* device, const char** message) = nullptr;
  int (*device_int)(void* device, const char* name) = nullptr;
  void* (*new_filter)(void* device, const char* type) = nullptr;
  void (*release_filter)(void* filter) = nullptr;
  void (*set_image)(void* filter, const char* name, void* values, int format, std::size_t width,
                    std::size_t height, std::size_t offset, std::size_t pixel_stride,
                    std::size_t row_stride) = nullptr;
  void (*set_bool)(void* filter, const char* name, bool value) = nullptr;
  void (*commit_filter)(void* filter) = nullptr;
  void (*execute)(void* filter) = nullptr;
  void* device = nullptr;
};

Denoiser::Denoiser(const std::filesystem::path& library)
    : library_(std::make_unique<const Library>(library)) {}
Denoiser::~Denoiser() = default;

std::string Denoiser::name() const {
  const auto number = [&](const char* part) { return library_->device_int(library_->device, part); };
  return fmt::format("Open Image Denoise {}.{}.{}", number("versionMajor"), number("versionMinor"),
                     number("versionPatch"));
}

Image Denoiser::denoise(const Image& radiance, const std::optional<Image>& albedo,
                        const std::optional<Image>& normal) const {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const Library& oidn = *library_;
  Image result(radiance.width, radiance.height);
  const std::unique_ptr<void, void (*)(void*)> filter(oidn.new_filter(oidn.device, "RT"),
                                                      oidn.release_filter);
  oidn.check();
  // A filter takes writable memory, though it only reads its inputs.
  const auto set = [&](const char* name, const Image& image) {
    if (image.width != radiance.width || image.height != radiance.height)
      throw InputError(fmt::format("the {} is of another size than the image", name));
    oidn.set_image(filter.get(), name, const_cast<Vec3f*>(image.pixels.data()), format_float3,
                   static_cast<std::size_t>(image.width), static_cast<std::size_t>(image.height), 0, 0, 0);
  };
  set("color", radiance);
  if (albedo) set("albedo", *albedo);
  if (albedo && normal) set("normal", *normal);
  set("output", result);
  oidn.set_bool(filter.get(), "hdr", true);
  oidn.commit_filter(filter.get());
  oidn.check();
  oidn.execute(filter.get());
  oidn.check();
  return result;
}

void refuse_denoised(const std::filesystem::path& file, const Metadata& metadata, const std::string& what) {
  if (const auto by = metadata.find(denoised_key); by != metadata.end())
    throw InputError({file.string()},
                     fmt::format("is denoised by {}, so it is biased: {}", printable(by->second), what));
}

}  // namespace castray
