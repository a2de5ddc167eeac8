#include "scene/gltf_accessor.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

namespace castray {

namespace {

constexpr std::string_view accessors = "accessors";

/// Elements at equal distances in a buffer.
struct Elements {
  const char* first = nullptr;  ///< null: all are 0
  std::size_t count = 0, stride = 0;
  int component_type = 0, components = 1;
  bool normalized = false;
};

std::size_t size_of_component(const GltfDocument& document, std::size_t index, int type) {
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(type));
  if (size < 0) document.fail(accessors, index, fmt::format("unknown component type {}", type));
  return static_cast<std::size_t>(size);
}

/// `elements`, with their place `offset` bytes into a view, which they must not leave.
Elements within_view(const GltfDocument& document, std::size_t index, int view, std::size_t offset,
                     Elements elements) {
  const std::string_view bytes = bytes_of_view(document, view, accessors, index);
  const std::size_t size = size_of_component(document, index, elements.component_type) *
                           static_cast<std::size_t>(elements.components);
  if (elements.stride == 0) elements.stride = size;
  if (elements.stride < size)
    document.fail(accessors, index,
                  fmt::format("elements of {} bytes every {} bytes overlap", size, elements.stride));
  const bool fits = offset <= bytes.size() && size <= bytes.size() - offset &&
                    (elements.count - 1) <= (bytes.size() - offset - size) / elements.stride;
  if (elements.count > 0 && !fits)
    document.fail(accessors, index,
                  fmt::format("{} elements of {} bytes do not fit in bufferViews[{}], which has {} bytes",
                              elements.count, size, view, bytes.size()));
  elements.first = bytes.data() + std::min(offset, bytes.size());
  return elements;
}

Elements elements_of(const GltfDocument& document, std::size_t index) {
  const tinygltf::Accessor& accessor = document.model.accessors[index];
  Elements elements{.count = accessor.count,
                    .component_type = accessor.componentType,
                    .components = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)),
                    .normalized = accessor.normalized};
  constexpr std::size_t most_without_bytes = 1u << 24;
  if (accessor.bufferView < 0) {
    if (accessor.count > most_without_bytes)
      document.fail(accessors, index, fmt::format("{} elements without a bufferView", accessor.count));
    return elements;
  }
  elements.stride =
      document.at(document.model.bufferViews, accessor.bufferView, "bufferViews", accessors, index)
          .byteStride;
  return within_view(document, index, accessor.bufferView, accessor.byteOffset, elements);
}

template <class To, class From>
To number_of(From stored, bool normalized) {
  if constexpr (std::is_integral_v<To> || std::is_floating_point_v<From>)
    return static_cast<To>(stored);
  else if (!normalized)
    return static_cast<To>(stored);
  else
    return std::max(static_cast<To>(stored) / static_cast<To>(std::numeric_limits<From>::max()), To(-1));
}

/// Writes element `i` of `elements` to the place `place(i)` of `numbers`.
template <class From, class To, class Place>
void copy_as(const Elements& elements, std::vector<To>& numbers, const Place& place) {
  const auto components = static_cast<std::size_t>(elements.components);
  for (std::size_t i = 0; i < elements.count; ++i) {
    To* to = numbers.data() + place(i) * components;
    for (std::size_t c = 0; c < components; ++c) {
      From stored;
      std::memcpy(&stored, elements.first + i * elements.stride + c * sizeof(From), sizeof(From));
      to[c] = number_of<To>(stored, elements.normalized);
    }
  }
}

template <class To, class Place>
void copy(const Elements& elements, std::vector<To>& numbers, const Place& place) {
  switch (elements.component_type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return copy_as<std::int8_t>(elements, numbers, place);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return copy_as<std::uint8_t>(elements, numbers, place);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return copy_as<std::int16_t>(elements, numbers, place);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return copy_as<std::uint16_t>(elements, numbers, place);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return copy_as<std::uint32_t>(elements, numbers, place);
    default:
      if constexpr (std::is_floating_point_v<To>) return copy_as<float>(elements, numbers, place);
  }
}

/// Puts in the elements that a sparse accessor has otherwise.
template <class To>
void replace_sparse(const GltfDocument& document, std::size_t index, Elements values,
                    std::vector<To>& numbers) {
  const auto& sparse = document.model.accessors[index].sparse;
  if (sparse.count < 0 || static_cast<std::size_t>(sparse.count) > values.count ||
      sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    document.fail(accessors, index, "its sparse elements are more than it has, or begin below 0");
  Elements places{.count = static_cast<std::size_t>(sparse.count),
                  .component_type = sparse.indices.componentType};
  places = within_view(document, index, sparse.indices.bufferView,
                       static_cast<std::size_t>(sparse.indices.byteOffset), places);
  std::vector<std::uint32_t> at(places.count);
  copy(places, at, [](std::size_t i) { return i; });
  for (const std::uint32_t place : at)
    if (place >= values.count)
      document.fail(
          accessors, index,
          fmt::format("sparse index {} is out of range: valid are 0 .. {}", place, values.count - 1));
  values.count = at.size();
  values.stride = 0;
  values = within_view(document, index, sparse.values.bufferView,
                       static_cast<std::size_t>(sparse.values.byteOffset), values);
  copy(values, numbers, [&at](std::size_t i) { return at[i]; });
}

template <class To>
std::vector<To> read_numbers(const GltfDocument& document, std::size_t index) {
  const Elements elements = elements_of(document, index);
  std::vector<To> numbers(elements.count * static_cast<std::size_t>(elements.components));
  if (elements.first) copy(elements, numbers, [](std::size_t i) { return i; });
  if (document.model.accessors[index].sparse.isSparse) replace_sparse(document, index, elements, numbers);
  return numbers;
}

const tinygltf::Accessor& accessor_at(const GltfDocument& document, int index, std::string_view user_list,
                                      std::size_t user) {
  return document.at(document.model.accessors, index, accessors, user_list, user);
}

}  // namespace

std::string_view bytes_of_view(const GltfDocument& document, int view, std::string_view user_list,
                               std::size_t user) {
  const tinygltf::BufferView& v =
      document.at(document.model.bufferViews, view, "bufferViews", user_list, user);
  const auto number = static_cast<std::size_t>(view);
  const std::vector<unsigned char>& data =
      document.at(document.model.buffers, v.buffer, "buffers", "bufferViews", number).data;
  if (v.byteOffset > data.size() || v.byteLength > data.size() - v.byteOffset)
    document.fail("bufferViews", number,
                  fmt::format("bytes {} .. {} are not all in buffers[{}], which has {}", v.byteOffset,
                              v.byteOffset + v.byteLength, v.buffer, data.size()));
  return {reinterpret_cast<const char*>(data.data()) + v.byteOffset, v.byteLength};
}

int components_of(const GltfDocument& document, int index, std::string_view user_list, std::size_t user) {
  return tinygltf::GetNumComponentsInType(
      static_cast<std::uint32_t>(accessor_at(document, index, user_list, user).type));
}

std::vector<float> read_floats(const GltfDocument& document, int index, int components,
                               std::string_view user_list, std::size_t user) {
  const tinygltf::Accessor& accessor = accessor_at(document, index, user_list, user);
  const auto number = static_cast<std::size_t>(index);
  if (const int found = components_of(document, index, user_list, user); found != components)
    document.fail(
        accessors, number,
        fmt::format("its elements have {} numbers; {}[{}] needs {}", found, user_list, user, components));
  if (accessor.componentType == TINYGLTF_COMPONENT_TYPE_INT ||
      accessor.componentType == TINYGLTF_COMPONENT_TYPE_DOUBLE)
    document.fail(accessors, number, "of a component type that glTF does not have");
  return read_numbers<float>(document, number);
}

std::vector<std::uint32_t> read_indices(const GltfDocument& document, int index, std::string_view user_list,
                                        std::size_t user) {
  const tinygltf::Accessor& accessor = accessor_at(document, index, user_list, user);
  const int type = accessor.componentType;
  if (accessor.type != TINYGLTF_TYPE_SCALAR ||
      (type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE && type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
       type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT))
    document.fail(accessors, static_cast<std::size_t>(index), "indices must be unsigned whole numbers");
  return read_numbers<std::uint32_t>(document, static_cast<std::size_t>(index));
}

}  // namespace castray
