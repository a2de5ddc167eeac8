#pragma once

#include <string_view>

#include "castray/vec.h"
#include "scene/gltf_document.h"

namespace castray {

// Members of the JSON objects that tinygltf hands on as they are: extensions.

/// The extension of that name; null where the object has none, or it is no object.
inline const tinygltf::Value* find_extension(const tinygltf::ExtensionMap& extensions, const char* name) {
  const auto found = extensions.find(name);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

/// A member; null where there is none. `object` may be null.
inline const tinygltf::Value* find_value(const tinygltf::Value* object, const char* key) {
  return object && object->IsObject() && object->Has(key) ? &object->Get(key) : nullptr;
}

inline double number_in(const tinygltf::Value* object, const char* key, double otherwise) {
  const tinygltf::Value* value = find_value(object, key);
  return value && value->IsNumber() ? value->GetNumberAsDouble() : otherwise;
}

inline int integer_in(const tinygltf::Value* object, const char* key, int otherwise) {
  const tinygltf::Value* value = find_value(object, key);
  return value && value->IsInt() ? value->GetNumberAsInt() : otherwise;
}

inline std::string text_in(const tinygltf::Value* object, const char* key, const std::string& otherwise) {
  const tinygltf::Value* value = find_value(object, key);
  return value && value->IsString() ? value->Get<std::string>() : otherwise;
}

/// Element `i` of a list of numbers.
inline double number_at(const tinygltf::Value* list, std::size_t i, double otherwise) {
  if (!list || !list->IsArray() || i >= list->ArrayLen()) return otherwise;
  const tinygltf::Value& value = list->Get(static_cast<int>(i));
  return value.IsNumber() ? value.GetNumberAsDouble() : otherwise;
}

inline Vec3d vector_in(const tinygltf::Value* object, const char* key, const Vec3d& otherwise) {
  const tinygltf::Value* list = find_value(object, key);
  return {number_at(list, 0, otherwise.x), number_at(list, 1, otherwise.y), number_at(list, 2, otherwise.z)};
}

}  // namespace castray
