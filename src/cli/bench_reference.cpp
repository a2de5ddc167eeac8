#include "cli/bench_reference.h"

#include <fmt/core.h>

#include "castray/error.h"
#include "plan/job.h"

namespace castray::cli {

namespace {

/// Seeds of the two references; measurements use small ones.
constexpr std::uint64_t reference_seeds[] = {0x5eed000000000001, 0x5eed000000000002};

std::string replaced(std::string text, const std::string& place, const std::string& value) {
  for (std::size_t at = text.find(place); at != std::string::npos; at = text.find(place, at + value.size()))
    text.replace(at, place.size(), value);
  return text;
}

Image read_radiance(const std::string& file) {
  const ImageFile image = read_image(file);
  if (image.encoded)
    throw InputError(file + ": references need linear radiance; use .pfm, .exr, .hdr or .film");
  return image.image;
}

/// Whether a film's key is `key`, or that with what pilots decided behind it.
bool is_of(const std::string& film_key, const std::string& key) {
  return film_key.starts_with(key) && (film_key.size() == key.size() || film_key[key.size()] == ';');
}

/// The film of an earlier run, if `file` holds one of this very render with enough samples, or one that it
/// can go on from; what another version of the program left there is made anew.
std::optional<Film> kept_film(const std::filesystem::path& file, const std::string& key,
                              std::uint64_t samples) try {
  if (!std::filesystem::exists(file)) return std::nullopt;
  Film film = read_film(file);
  if (!is_of(film.key, key) || film.samples.size() != 1 || film.samples[0].first != 0) return std::nullopt;
  if (film.key != key && film.samples[0].count < samples) return std::nullopt;  // pilots may decide otherwise
  return film;
} catch (const InputError&) {
  return std::nullopt;
}

}  // namespace

ReferencePair read_references(const std::string& text, const std::string& scene_name) {
  const std::size_t comma = text.find(',');
  if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos)
    throw InputError(fmt::format("--reference '{}': give two independent images as A,B", text));
  const std::string names = replaced(text, "{scene}", scene_name);
  const std::size_t middle = names.find(',');
  const std::string a = names.substr(0, middle), b = names.substr(middle + 1);
  ReferencePair pair{read_radiance(a), read_radiance(b)};
  if (pair.a.width != pair.b.width || pair.a.height != pair.b.height)
    throw InputError(fmt::format("{}: {}x{} pixels, but {} has {}x{}; references need one size", a,
                                 pair.a.width, pair.a.height, b, pair.b.width, pair.b.height));
  return pair;
}

ReferencePair cached_references(const Scene& scene, const RenderRequest& request,
                                const std::filesystem::path& cache,
                                const std::function<void(int, const Progress&)>& progress) {
  std::error_code failed;
  std::filesystem::create_directories(cache, failed);
  if (failed)
    throw InputError(fmt::format("{}: {}; give another folder by --cache", cache.string(), failed.message()));
  Image images[2];
  const SceneFacts facts = facts_of(scene);
  std::optional<PreparedScene> prepared;
  RenderOptions options = request.options;
  for (int i = 0; i < 2; ++i) {
    options.seed = reference_seeds[i];
    const std::string key = make_job(facts, options, request.fault).key;
    const auto file =
        cache / fmt::format("{}-{}x{}-{}.film", scene.name, options.width, options.height, "AB"[i]);
    std::optional<Film> film = kept_film(file, key, options.spp);
    if (!film || film->samples[0].count < options.spp) {
      const auto tell = [&](const Progress& now) { return progress(i, now), true; };
      if (!prepared) prepared = prepare(scene, request);
      film = render(*prepared, options, tell, film ? &*film : nullptr).film;
      write_film(file, *film);
    }
    images[i] = image_of(*film, options.threads);
  }
  return {std::move(images[0]), std::move(images[1])};
}

}  // namespace castray::cli
