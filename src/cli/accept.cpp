#include <fmt/format.h>

#include <memory>

#include "castray/denoise.h"
#include "castray/error.h"
#include "castray/image.h"
#include "cli/commands.h"
#include "cli/image_folder.h"
#include "core/files.h"

namespace castray::cli {

namespace {

namespace fs = std::filesystem;

/// Puts `image` in the place of `reference`, byte for byte.
void replace_file(const fs::path& image, const fs::path& reference) {
  const std::string bytes = read_file(image);
  std::error_code ignored;
  if (fs::exists(reference, ignored) && read_file(reference) == bytes) {
    fmt::print("same      {}\n", reference.string());
    return;
  }
  const bool is_new = !fs::exists(reference, ignored);
  write_file(reference, bytes);
  fmt::print("{}  {}\n", is_new ? "new     " : "replaced", reference.string());
}

/// Replaces an image, with the variances beside it, once it is known to be one that can be read.
void accept_file(const fs::path& image, const fs::path& reference) {
  if (suffix_of(image) != suffix_of(reference))
    throw InputError({reference.string()},
                     "has another suffix than " + image.string() + "; convert the image first");
  refuse_denoised(image, read_image(image).metadata, "it cannot be a reference");
  replace_file(image, reference);
  if (suffix_of(image) == ".pfm" && fs::exists(variance_file(image)))
    replace_file(variance_file(image), variance_file(reference));
}

int accept(const fs::path& image, const fs::path& reference) {
  if (!fs::exists(image)) throw InputError({image.string()}, "does not exist");
  if (!fs::is_directory(image)) {
    accept_file(image, reference);
    return 0;
  }
  if (fs::exists(reference) && !fs::is_directory(reference))
    throw InputError({reference.string()}, "is not a folder, but IMAGE is");
  bool any_film = false;
  for (const std::string& name : images_below(image)) {
    any_film |= is_film_format(name);
    fs::create_directories((reference / name).parent_path());
    accept_file(image / name, reference / name);
  }
  fmt::print("references: {}\n", size_text(reference));
  if (any_film)
    fmt::print("as .exr of 'castray render --replicates 16 --bits 16', films take about a sixteenth\n");
  return 0;
}

}  // namespace

Run add_accept(Arguments& arguments, const CommonFlags&) {
  struct Files {
    fs::path image, reference;
  };
  auto files = std::make_shared<Files>();
  arguments.add_positional("IMAGE", files->image, "an image or film, or a folder of them").required();
  arguments
      .add_positional("REFERENCE", files->reference,
                      "the file or folder that it shall replace; made where there is none")
      .required();
  return [files] { return accept(files->image, files->reference); };
}

}  // namespace castray::cli
