#pragma once

#include <string>
#include <vector>

namespace castray {

/// A part of an OpenEXR file: its name, empty in files of a single part, and its channels' full names.
struct ExrPart {
  std::string name;
  std::vector<std::string> channels;
};

/// Channels of a part that make up one picture.
struct ExrLayer {
  enum class Kind { rgb, luminance_chroma, xyz, grey };
  std::size_t part = 0;
  std::string name;  ///< what stands before the last dot of its channels' names, else the part's name
  Kind kind = Kind::rgb;
  bool is_plain = false;              ///< colours without a layer's name
  std::vector<std::string> channels;  ///< full names: R G B, Y RY BY, X Y Z, or one
  std::string alpha;                  ///< full name; empty: none
};

/// Every channel is in a layer or is its alpha. Channels that make up no colour are layers of their own,
/// under their full names where there are several.
std::vector<ExrLayer> layers_of(const std::vector<ExrPart>& parts);

/// Whether it holds castray's variances of another layer.
bool is_variance(const ExrLayer& layer);

/// The layer of this name. Empty: the first part's colours without a layer's name, else its only R, G, B,
/// else the file's only R, G, B, else the only layer. A file whose only layer is colours without a name gives
/// these whatever the name. Throws InputError that lists the layers where none is found.
const ExrLayer& choose_layer(const std::vector<ExrLayer>& layers, const std::string& name);

/// "ViewLayer.Combined (R G B A)".
std::string to_string(const ExrLayer& layer);

}  // namespace castray
