// The image readers; the first byte chooses the format.
#include <iterator>

#include "fuzz.h"
#include "image/formats.h"

FUZZ(bytes) {
  if (bytes.empty()) return;
  using Read = castray::Decoded (*)(const std::string&, std::string_view);
  constexpr Read readers[] = {
      castray::read_netpbm,
      castray::read_pfm,
      castray::read_png,
      castray::read_hdr,
      [](const std::string& name, std::string_view file) { return castray::read_exr(name, file, ""); },
      castray::read_jpeg,
      castray::read_tga,
      castray::read_bmp,
      castray::read_gif,
      castray::read_psd};
  const auto choice = static_cast<unsigned char>(bytes.front());
  castray::colours_of(readers[choice % std::size(readers)]("fuzz", bytes.substr(1)).raster);
}
