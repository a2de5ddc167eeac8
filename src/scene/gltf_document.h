#pragma once

#include <tiny_gltf.h>

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/json_document.h"
#include "scene/warning_list.h"

namespace castray {

/// A glTF 2.0 file as tinygltf reads it. What one part of it says of another, by number, is not checked yet:
/// `at` does that.
struct GltfDocument {
  std::filesystem::path path;
  tinygltf::Model model;
  JsonNode json;           ///< the same, with places
  bool is_binary = false;  ///< .glb: lines mean nothing to a reader

  /// Of the member `index` of one of the file's lists ("accessors"), as far as it has a line.
  SourcePlace place(std::string_view list, std::size_t index) const;

  /// Throws InputError with that place; the message begins with "accessors[2]: ".
  [[noreturn]] void fail(std::string_view list, std::size_t index, const std::string& what) const;

  /// The radiance or intensity `value` of that element, 0 where it is negative or too small for floats.
  /// Throws InputError where it is too great; the message begins with `what` and the value.
  double radiance(std::string_view list, std::size_t index, const std::string& what, double value) const;

  /// Warns at that place, in the same form.
  void warn(WarningList& warnings, std::string_view list, std::size_t index, const std::string& what) const;

  /// The element `index` of `elements`, the file's `list`; throws InputError at `user` where there is none.
  template <class T>
  const T& at(const std::vector<T>& elements, int index, std::string_view list, std::string_view user_list,
              std::size_t user) const {
    if (index < 0 || static_cast<std::size_t>(index) >= elements.size())
      fail_of_index(index, elements.size(), list, user_list, user);
    return elements[static_cast<std::size_t>(index)];
  }

 private:
  [[noreturn]] void fail_of_index(int index, std::size_t count, std::string_view list,
                                  std::string_view user_list, std::size_t user) const;
};

/// Reads a .gltf or .glb file, or the bytes that are its content, and the buffers beside it; images are left
/// where they are. Warns of extensions that are not supported; throws InputError where they are required, and
/// of what is broken.
GltfDocument read_gltf(const std::filesystem::path& file, WarningList& warnings);
GltfDocument parse_gltf(std::string_view bytes, const std::filesystem::path& file, WarningList& warnings);

/// Whether the bytes begin as those of a .glb file.
bool is_binary_gltf(std::string_view bytes);

}  // namespace castray
