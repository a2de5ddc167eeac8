#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "castray/image.h"

namespace castray {

/// Metadata of denoised images: by what. They are biased, so they are no references.
inline constexpr const char* denoised_key = "castray:denoised";

/// Throws InputError where the metadata of `file` say that it is denoised; `what` it cannot be used for.
void refuse_denoised(const std::filesystem::path& file, const Metadata& metadata, const std::string& what);

/// Intel's Open Image Denoise, loaded when it is needed: castray is built without it.
class Denoiser {
 public:
  /// Loads `library`, or where that is empty libOpenImageDenoise.so of version 2 or 1 from where the system
  /// has libraries. Throws InputError that says what to install.
  explicit Denoiser(const std::filesystem::path& library);
  ~Denoiser();
  Denoiser(const Denoiser&) = delete;
  Denoiser& operator=(const Denoiser&) = delete;

  std::string name() const;  ///< "Open Image Denoise 2.3.3"

  /// Radiance with less noise, and with bias. The albedo in [0,1] and the normals, where there are any, are
  /// of what the camera sees, of the image's size; normals are used with an albedo only. Throws InputError.
  Image denoise(const Image& radiance, const std::optional<Image>& albedo,
                const std::optional<Image>& normal) const;

 private:
  struct Library;
  std::unique_ptr<const Library> library_;
};

}  // namespace castray
