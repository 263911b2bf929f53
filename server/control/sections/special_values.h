#pragma once
// Readers and printers for special keys of the usual kinds.
#include <array>
#include <string>
#include <vector>

#include "server/control/sections/section.h"

namespace obliq {

/// "[a, b]" of whatever `each` makes of the items.
template <class Items, class Each>
std::string toml_list(const Items& items, Each each) {
  std::string text = "[";
  for (const auto& item : items) text += (text.size() > 1 ? ", " : "") + each(item);
  return text + "]";
}

/// A path as GDAL and the file system want it. Absolute ones, URLs, /vsi... and DRIVER:... stay as they are.
/// Those of a flag count from the working directory, those of the file from its folder.
std::string resolved_path(const ConfigNode& node, const std::filesystem::path& folder);

/// [[lon, lat], ...] of at least three corners that enclose something; empty when it is not that.
std::vector<LonLat> polygon_of(const ConfigNode& node);
std::string printed_polygon(const std::vector<LonLat>& corners);

/// Complains if the table does not name the key.
void require(SceneReading& scene, const SectionReader& reader, std::string_view name,
             const std::string& allowed);

void read_material(const FoundKey& found, std::uint8_t& id);
/// [least, most], or one number for both.
void read_span(const FoundKey& found, std::array<double, 2>& span);

template <auto member, class T>
void read_path(const FoundKey& found, T& object) {
  if (found.text() == nullptr) return found.refuse();
  object.*member = resolved_path(found.node, found.scene.folder);
}

template <auto member, class T>
void read_text(const FoundKey& found, T& object) {
  found.reader.read(found.name, found.key, &(object.*member));
}

template <auto member, class T>
std::string printed_text(const T& object, const SceneConfig&) {
  return (object.*member).empty() ? "" : toml_string(object.*member);
}

template <auto member, class T>
void read_span(const FoundKey& found, T& object) {
  read_span(found, object.*member);
}

template <auto member, class T>
std::string printed_span(const T& object, const SceneConfig&) {
  return toml_list(object.*member, toml_number);
}

template <class T>
void read_material(const FoundKey& found, T& object) {
  read_material(found, object.material);
}

template <class T>
std::string printed_material(const T& object, const SceneConfig& config) {
  return toml_string(config.materials.at(object.material).name);
}

}  // namespace obliq
