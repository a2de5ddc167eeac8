// The image readers; the first byte chooses the format.
#include <iterator>

#include "fuzz.h"
#include "image/formats.h"

FUZZ(bytes) {
  if (bytes.empty()) return;
  using Read = castray::ImageFile (*)(const std::string&, std::string_view);
  constexpr Read readers[] = {castray::read_ppm, castray::read_pfm, castray::read_png, castray::read_hdr,
                              castray::read_exr};
  const auto choice = static_cast<unsigned char>(bytes.front());
  readers[choice % std::size(readers)]("fuzz", bytes.substr(1));
}
