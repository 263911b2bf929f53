#include "server/control/sections/special_values.h"

#include <cmath>

#include "server/control/sections/materials.h"

namespace obliq {

std::string resolved_path(const ConfigNode& node, const std::filesystem::path& folder) {
  const std::string& text = std::get<std::string>(node.value);
  const std::size_t colon = text.find(':');
  const bool has_scheme = colon != std::string::npos && colon > 0 && text.find('/') > colon;
  if (text.front() == '/' || has_scheme) return text;
  const auto base = node.layer == 0 ? folder : std::filesystem::current_path();
  return (base / text).lexically_normal().string();
}

std::vector<LonLat> polygon_of(const ConfigNode& node) {
  std::vector<LonLat> corners;
  for (const ConfigNode& item : node.items) {
    Complaints ignored;
    ConfigNode holder;
    holder.items = {item};
    holder.items[0].key = "corner";
    // Beyond 180: outlines across the antimeridian run on.
    const auto pair = SectionReader(holder, "", ignored).numbers("corner", closed(-360, 360), 2, 2);
    if (pair.size() != 2 || std::abs(pair[1]) > 90) return {};
    corners.push_back({pair[0], pair[1]});
  }
  double doubled_area = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const LonLat& a = corners[i];
    const LonLat& b = corners[(i + 1) % corners.size()];
    doubled_area += a.longitude_deg * b.latitude_deg - b.longitude_deg * a.latitude_deg;
  }
  return corners.size() >= 3 && doubled_area != 0 ? corners : std::vector<LonLat>{};
}

std::string printed_polygon(const std::vector<LonLat>& corners) {
  return toml_list(corners, [](const LonLat& corner) {
    return "[" + toml_number(corner.longitude_deg) + ", " + toml_number(corner.latitude_deg) + "]";
  });
}

void require(SceneReading& scene, const SectionReader& reader, std::string_view name,
             const std::string& allowed) {
  if (reader.table().find(name) == nullptr)
    scene.complaints.add(reader.table().where, {reader.full_name(name), "nothing", allowed});
}

void read_material(const FoundKey& found, std::uint8_t& id) {
  std::string name;
  if (!found.reader.read(found.name, Key{found.name, ""}, &name)) return;
  const std::vector<Material>& materials = found.scene.config.materials;
  if (const auto known = find_material(materials, name)) {
    id = static_cast<std::uint8_t>(*known);
    return;
  }
  std::string names;
  for (const Material& material : materials)
    names += (names.empty() ? "" : " | ") + toml_string(material.name);
  found.reader.complain(found.node, found.name, names);
}

void read_span(const FoundKey& found, std::array<double, 2>& span) {
  const auto values = found.reader.numbers(found.name, found.key.limits, 1, 2);
  if (values.empty()) return;
  if (values.front() > values.back())
    found.reader.complain(found.node, found.name, "[least, most] with least no more than most");
  span = {values.front(), values.back()};
}

}  // namespace obliq
