#include "image/exr_layers.h"

#include <algorithm>
#include <map>
#include <set>

#include "castray/error.h"
#include "core/text.h"

namespace castray {

namespace {

using Kind = ExrLayer::Kind;

struct Group {
  std::string prefix;          ///< with its dot; empty: none
  std::set<std::string> base;  ///< names behind the prefix

  bool has(const std::vector<std::string>& names) const {
    return std::all_of(names.begin(), names.end(), [&](const auto& name) { return base.contains(name); });
  }
};

std::vector<Group> groups_of(const ExrPart& part) {
  std::vector<Group> groups;
  for (const std::string& channel : part.channels) {
    const std::size_t begin = channel.rfind('.') + 1;  // npos + 1: 0
    const std::string prefix = channel.substr(0, begin);
    auto group =
        std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.prefix == prefix; });
    if (group == groups.end()) group = groups.insert(group, {prefix, {}});
    group->base.insert(channel.substr(begin));
  }
  return groups;
}

struct Pattern {
  Kind kind;
  std::vector<std::string> names;
};
const std::vector<Pattern>& patterns() {
  static const std::vector<Pattern> all{{Kind::rgb, {"R", "G", "B"}},
                                        {Kind::rgb, {"r", "g", "b"}},
                                        {Kind::luminance_chroma, {"Y", "RY", "BY"}},
                                        {Kind::xyz, {"X", "Y", "Z"}},
                                        {Kind::grey, {"Y"}}};
  return all;
}

/// What stands before the channels' names, else the part's name.
std::string name_of(const ExrPart& part, const Group& group) {
  return group.prefix.empty() ? part.name : group.prefix.substr(0, group.prefix.size() - 1);
}

/// Takes channels of `group` and, to colours, its alpha.
ExrLayer take(Group& group, std::string name, Kind kind, const std::vector<std::string>& bases) {
  ExrLayer layer{0, std::move(name), kind, false, {}, {}};
  for (const std::string& base : bases) {
    layer.channels.push_back(group.prefix + base);
    group.base.erase(base);
  }
  return layer;
}

void add_layers(std::vector<ExrLayer>& layers, const ExrPart& part, Group group) {
  const auto pattern = std::find_if(patterns().begin(), patterns().end(),
                                    [&](const Pattern& p) { return group.has(p.names); });
  if (pattern != patterns().end()) {
    ExrLayer layer = take(group, name_of(part, group), pattern->kind, pattern->names);
    layer.is_plain = group.prefix.empty();
    for (const char* alpha : {"A", "a"})
      if (layer.alpha.empty() && group.base.erase(alpha)) layer.alpha = group.prefix + alpha;
    layers.push_back(std::move(layer));
  } else if (group.base.size() == 1 && !name_of(part, group).empty()) {
    layers.push_back(take(group, name_of(part, group), Kind::grey, {*group.base.begin()}));
  }
  while (!group.base.empty()) {
    const std::string base = *group.base.begin();
    layers.push_back(take(group, group.prefix + base, Kind::grey, {base}));
  }
}

std::string list_of(const std::vector<ExrLayer>& layers) {
  constexpr std::size_t longest_list = 20;
  std::string list;
  for (std::size_t i = 0; i < layers.size() && i < longest_list; ++i)
    list += (i ? ", " : "") + to_string(layers[i]);
  return list + (layers.size() > longest_list ? ", ..." : "");
}

/// The only one of `layers` that is wanted, or null.
template <class Wanted>
const ExrLayer* only(const std::vector<ExrLayer>& layers, Wanted wanted) {
  const auto first = std::find_if(layers.begin(), layers.end(), wanted);
  if (first == layers.end() || std::find_if(first + 1, layers.end(), wanted) != layers.end()) return nullptr;
  return &*first;
}

const ExrLayer* default_layer(const std::vector<ExrLayer>& layers) {
  const auto is_picture = [](const ExrLayer& layer) { return !is_variance(layer); };
  const auto is_rgb = [](const ExrLayer& layer) { return layer.kind == Kind::rgb && !is_variance(layer); };
  const ExrLayer* found =
      only(layers, [](const ExrLayer& layer) { return layer.is_plain && layer.part == 0; });
  if (!found) found = only(layers, [&](const ExrLayer& layer) { return is_rgb(layer) && layer.part == 0; });
  if (!found) found = only(layers, is_rgb);
  return found ? found : only(layers, is_picture);
}

}  // namespace

std::vector<ExrLayer> layers_of(const std::vector<ExrPart>& parts) {
  std::vector<ExrLayer> layers;
  std::map<std::string, int> uses;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const std::size_t first = layers.size();
    for (const Group& group : groups_of(parts[i])) add_layers(layers, parts[i], group);
    for (std::size_t k = first; k < layers.size(); ++k) layers[k].part = i, ++uses[layers[k].name];
  }
  for (ExrLayer& layer : layers)
    if (const std::string& part = parts[layer.part].name; uses[layer.name] > 1 && layer.name != part)
      layer.name = part + "." + layer.name;
  return layers;
}

bool is_variance(const ExrLayer& layer) { return layer.name == "variance" && layer.kind == Kind::rgb; }

const ExrLayer& choose_layer(const std::vector<ExrLayer>& layers, const std::string& name) {
  const ExrLayer* found = name.empty() ? default_layer(layers) : nullptr;
  if (!name.empty()) {
    const auto named =
        std::find_if(layers.begin(), layers.end(), [&](const ExrLayer& layer) { return layer.name == name; });
    found = named != layers.end() ? &*named
                                  : only(layers, [](const ExrLayer& layer) { return !is_variance(layer); });
    if (found && named == layers.end() && !(found->is_plain && found->name.empty())) found = nullptr;
  }
  if (found) return *found;
  if (layers.empty()) throw InputError("it has no channels");
  throw InputError((name.empty() ? "it holds several layers; choose one with --layer NAME: "
                                 : "it has no layer '" + printable(name) + "'; its layers are ") +
                   list_of(layers));
}

std::string to_string(const ExrLayer& layer) {
  std::string channels;
  for (std::string channel : layer.channels)
    channels += (channels.empty() ? "" : " ") + channel.substr(channel.rfind('.') + 1);
  if (!layer.alpha.empty()) channels += " " + layer.alpha.substr(layer.alpha.rfind('.') + 1);
  return printable(layer.name.empty() ? channels : layer.name + " (" + channels + ")");
}

}  // namespace castray
