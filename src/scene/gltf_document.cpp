#include "scene/gltf_document.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstring>
#include <limits>

#include "castray/error.h"
#include "core/files.h"
#include "core/range.h"
#include "core/text.h"
#include "scene/file_finder.h"

namespace castray {

namespace {

constexpr std::string_view supported_extensions[] = {
    "KHR_mesh_quantization",      "KHR_lights_punctual",
    "KHR_texture_transform",      "KHR_materials_emissive_strength",
    "KHR_materials_transmission", "KHR_materials_volume",
    "KHR_materials_ior",          "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",    "KHR_materials_sheen",
    "KHR_materials_specular",     "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_unlit",        "EXT_mesh_gpu_instancing"};

/// What a picture of one moment does not show.
constexpr std::string_view harmless_extensions[] = {"KHR_xmp_json_ld", "KHR_materials_variants",
                                                    "KHR_animation_pointer"};

constexpr std::string_view compressions[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                             "KHR_meshopt_compression"};

template <std::size_t N>
bool is_one_of(std::string_view name, const std::string_view (&names)[N]) {
  return std::ranges::find(names, name) != std::end(names);
}

const JsonNode* member(const JsonNode* node, std::string_view key) {
  if (!node || node->type != JsonNode::Type::object) return nullptr;
  const auto found = std::ranges::find(node->children, key, &JsonNode::key);
  return found == node->children.end() ? nullptr : &*found;
}

/// The elements of a list of the file; none where there is no such list.
const std::vector<JsonNode>& list_of(const JsonNode& root, std::string_view key) {
  static const std::vector<JsonNode> none;
  const JsonNode* list = member(&root, key);
  return list && list->type == JsonNode::Type::array ? list->children : none;
}

std::uint32_t word_at(std::string_view bytes, std::size_t offset) {
  std::uint32_t word;
  std::memcpy(&word, bytes.data() + offset, sizeof(word));
  return word;
}

constexpr std::size_t glb_header = 12, chunk_header = 8;

/// The JSON of a .glb file, whose chunks must lie within it: tinygltf relies on that.
std::string_view json_of_binary(std::string_view bytes, const std::string& name) {
  const auto fail = [&name](const std::string& what) { throw InputError(SourcePlace{name}, what); };
  if (bytes.size() < glb_header + chunk_header) fail("the file is too short for a binary glTF");
  if (const std::uint32_t version = word_at(bytes, 4); version != 2)
    fail(fmt::format("version {} of binary glTF; version 2 is read", version));
  if (const std::uint32_t length = word_at(bytes, 8); length > bytes.size())
    fail(fmt::format("the file ends at byte {} of {}; it is truncated", bytes.size(), length));
  const std::string_view within = bytes.substr(0, word_at(bytes, 8));
  std::string_view json;
  for (std::size_t at = glb_header; at < within.size();) {
    if (within.size() - at < chunk_header) fail("the last chunk has no header; the file is broken");
    const std::size_t length = word_at(within, at);
    if (length > within.size() - at - chunk_header)
      fail(fmt::format("the chunk at byte {} is longer than the file", at));
    if (at == glb_header) json = within.substr(at + chunk_header, length);
    at += chunk_header + length;
  }
  return json;
}

void check_extensions(const JsonNode& json, const std::string& name, bool is_binary, WarningList& warnings) {
  const auto place = [&](const JsonNode& node) { return is_binary ? SourcePlace{name} : node.place; };
  for (const JsonNode& required : list_of(json, "extensionsRequired")) {
    if (is_one_of(required.text, compressions))
      throw InputError(place(required),
                       fmt::format("the meshes are compressed by {}, which is not read; export "
                                   "the file without compression",
                                   required.text));
    if (!is_one_of(required.text, supported_extensions))
      throw InputError(place(required), fmt::format("the file requires the extension {}, which is not read",
                                                    printable(required.text)));
  }
  for (const JsonNode& used : list_of(json, "extensionsUsed"))
    if (!is_one_of(used.text, supported_extensions))
      warnings.add(
          place(used),
          fmt::format("the extension {} is not read; what it adds is left out", printable(used.text)),
          is_one_of(used.text, harmless_extensions) ? Harm::none : Harm::changes_picture);
}

void check_version(const JsonNode& json, const std::string& name, bool is_binary) {
  const JsonNode* version = member(member(&json, "asset"), "version");
  const JsonNode* accessors = member(&json, "accessors");
  const bool is_first = accessors && accessors->type == JsonNode::Type::object;  // it held them by name
  if (!is_first && (!version || version->text.starts_with("2."))) return;
  throw InputError(is_binary ? SourcePlace{name} : (version ? version : accessors)->place,
                   fmt::format("version {} of glTF; version 2 is read: export the file anew, or convert it",
                               version && !is_first ? printable(version->text) : "1"));
}

/// What tinygltf asks of the file system. It reads buffers first, in their order, then images, which are not
/// wanted yet.
struct FileAccess {
  struct Buffer {
    std::size_t index, length;
    std::string uri;
  };
  std::vector<Buffer> buffers;  ///< those in files of their own
  std::size_t buffers_read = 0;

  explicit FileAccess(const JsonNode& json) {
    std::size_t index = 0;
    for (const JsonNode& buffer : list_of(json, "buffers")) {
      const JsonNode *uri = member(&buffer, "uri"), *length = member(&buffer, "byteLength");
      if (uri && !uri->text.empty() && !uri->text.starts_with("data:"))
        buffers.push_back(
            {index, length && length->number > 0 ? static_cast<std::size_t>(length->number) : 0, uri->text});
      ++index;
    }
  }

  bool wants_image() const { return buffers_read == buffers.size(); }

  void fail_of_missing(const GltfDocument& document) const {
    if (wants_image()) return;
    const Buffer& buffer = buffers[buffers_read];
    document.fail("buffers", buffer.index,
                  fmt::format("no such file: {}; put it beside the glTF file, or export one .glb",
                              printable(buffer.uri)));
  }

  static bool exists(const std::string& path, void* self) {
    return !static_cast<FileAccess*>(self)->wants_image() && is_file(path);
  }
  static std::string expand(const std::string& path, void*) { return path; }
  /// A file may be longer than the buffer that it holds.
  static bool read(std::vector<unsigned char>* bytes, std::string*, const std::string& path, void* self) {
    auto& access = *static_cast<FileAccess*>(self);
    const std::string content = read_file(path);
    const std::size_t length = std::min(content.size(), access.buffers[access.buffers_read++].length);
    bytes->assign(content.begin(), content.begin() + static_cast<std::ptrdiff_t>(length));
    return true;
  }
  static bool write(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
    return false;
  }
};

/// Of an image in a data URI, its bytes are kept; those in buffers are found there.
bool keep_bytes(tinygltf::Image* image, int, std::string*, std::string*, int, int, const unsigned char* bytes,
                int size, void*) {
  if (image->bufferView < 0) image->image.assign(bytes, bytes + size);
  return true;
}

/// The first of the lines in which tinygltf tells what is wrong.
std::string first_line(const std::string& text) {
  return text.empty() ? "not a glTF file" : printable(text.substr(0, text.find('\n')), 200);
}

}  // namespace

bool is_binary_gltf(std::string_view bytes) { return bytes.starts_with("glTF"); }

SourcePlace GltfDocument::place(std::string_view list, std::size_t index) const {
  const std::vector<JsonNode>& nodes = list_of(json, list);
  return is_binary || index >= nodes.size() ? SourcePlace{path.string()} : nodes[index].place;
}

void GltfDocument::fail(std::string_view list, std::size_t index, const std::string& what) const {
  throw InputError(place(list, index), fmt::format("{}[{}]: {}", list, index, what));
}

double GltfDocument::radiance(std::string_view list, std::size_t index, const std::string& what,
                              double value) const {
  if (!(value <= radiance_range.greatest))
    fail(list, index, fmt::format("{} {:g}; it must be {}", what, value, radiance_range.text()));
  return radiance_range.contains(value) ? value : 0;
}

void GltfDocument::warn(WarningList& warnings, std::string_view list, std::size_t index,
                        const std::string& what) const {
  warnings.add(place(list, index), fmt::format("{}[{}]: {}", list, index, what));
}

void GltfDocument::fail_of_index(int index, std::size_t count, std::string_view list,
                                 std::string_view user_list, std::size_t user) const {
  const std::string valid =
      count == 0 ? ": the file has none" : fmt::format(": valid are 0 .. {}", count - 1);
  fail(user_list, user, fmt::format("{}[{}] is out of range{}", list, index, valid));
}

GltfDocument parse_gltf(std::string_view bytes, const std::filesystem::path& file, WarningList& warnings) {
  GltfDocument document;
  document.path = file;
  const std::string name = file.string();
  document.is_binary = is_binary_gltf(bytes);
  if (bytes.size() > std::numeric_limits<unsigned>::max())
    throw InputError(SourcePlace{name}, "longer than 4 GiB; put its buffers into files of their own");
  document.json = parse_json(document.is_binary ? json_of_binary(bytes, name) : bytes, name);
  if (document.json.type != JsonNode::Type::object)
    throw InputError(document.json.place, "a glTF file is an object in braces");
  check_version(document.json, name, document.is_binary);
  check_extensions(document.json, name, document.is_binary, warnings);
  FileAccess access(document.json);
  tinygltf::TinyGLTF loader;
  loader.SetFsCallbacks(
      {FileAccess::exists, FileAccess::expand, FileAccess::read, FileAccess::write, &access});
  loader.SetImageLoader(keep_bytes, nullptr);
  std::string error, warning, folder = file.parent_path().string();
  if (folder.empty()) folder = ".";
  const auto length = static_cast<unsigned>(bytes.size());
  bool loaded = false;
  try {
    loaded =
        document.is_binary
            ? loader.LoadBinaryFromMemory(&document.model, &error, &warning,
                                          reinterpret_cast<const unsigned char*>(bytes.data()), length,
                                          folder)
            : loader.LoadASCIIFromString(&document.model, &error, &warning, bytes.data(), length, folder);
  } catch (const InputError&) {
    throw;
  } catch (const std::exception& odd) {
    error = odd.what();
  }
  if (!loaded && error.starts_with("File not found")) access.fail_of_missing(document);
  if (!loaded) throw InputError(SourcePlace{name}, first_line(error));
  return document;
}

GltfDocument read_gltf(const std::filesystem::path& file, WarningList& warnings) {
  return parse_gltf(read_file(file), file, warnings);
}

}  // namespace castray
