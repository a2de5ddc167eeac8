#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "scene/gltf_document.h"

namespace castray {

/// The bytes of a buffer view, which must lie within its buffer. Throws InputError.
std::string_view bytes_of_view(const GltfDocument& document, int view, std::string_view user_list,
                               std::size_t user);

/// The numbers of accessor `index`, which `user` of `user_list` names: `components` of them for each element,
/// side by side. Integers that are normalised become [0,1] or [-1,1]; sparse elements are put in. Throws
/// InputError where it has another type, or reaches over its buffer view.
std::vector<float> read_floats(const GltfDocument& document, int index, int components,
                               std::string_view user_list, std::size_t user);

/// The same of an accessor of whole numbers that count something.
std::vector<std::uint32_t> read_indices(const GltfDocument& document, int index, std::string_view user_list,
                                        std::size_t user);

/// How many numbers an element of the accessor has. Throws InputError where there is no such accessor.
int components_of(const GltfDocument& document, int index, std::string_view user_list, std::size_t user);

}  // namespace castray
