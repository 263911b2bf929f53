// [radar] or [[radar]], [antenna], [frustum], [bins].
#include <algorithm>
#include <array>
#include <map>

#include "server/control/parameters.h"
#include "server/control/quality_presets.h"
#include "server/control/scene_sections.h"

namespace obliq {

namespace {

using Kind = ConfigNode::Kind;

constexpr std::array kSubSections{"antenna", "frustum", "bins", "scan"};

/// One radar while it is read: its values, and where each was set.
struct RadarReading {
  RadarConfig config;
  std::map<std::string, std::string> set_at;
};

/// Reads the parameters of one section from a table that holds them.
void read_parameters(SectionReader& reader, const std::string& section, RadarReading& radar) {
  for (const Parameter& parameter : parameters()) {
    const std::string name(parameter.key.name);
    if (!name.starts_with(section + ".")) continue;
    const std::string local = name.substr(section.size() + 1);
    if (reader.read_unchecked(local, parameter.key, parameter.slot(radar.config)))
      radar.set_at[name] = reader.table().find(local)->where;
  }
  if (section == "frustum") {
    // What a radar names itself beats what all share.
    bool any = false;
    bool searched = true;
    for (const char* side : {"pixel_columns", "pixel_rows"})
      if (const ConfigNode* node = reader.table().find(side)) {
        any = true;
        searched &= node->searched;
      }
    if (any) radar.config.finds_pixels = searched;
    // A good one has been split into columns and rows before (overrides.h).
    if (const ConfigNode* pixels = reader.take("pixels"))
      reader.complain(*pixels, "pixels",
                      "integer 1 to 16384, or [columns, rows]; not beside pixel_columns and pixel_rows");
    if (const ConfigNode* quality = reader.take("quality"))
      reader.complain(*quality, "quality", quality_names());
  }
}

void read_sub_sections(SectionReader& holder, Complaints& complaints, RadarReading& radar) {
  for (const std::string section : kSubSections) {
    const ConfigNode* table = holder.take(section);
    if (table == nullptr) continue;
    if (table->kind != Kind::table) {
      holder.complain(*table, section, "a table");
      continue;
    }
    SectionReader reader(*table, section, complaints);
    read_parameters(reader, section, radar);
    reader.finish();
  }
}

void read_name(SectionReader& reader, std::string& name) {
  constexpr std::string_view kCharacters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  if (!reader.read("name", Key{"radar.name", ""}, &name)) return;
  if (name.empty() || name.size() > 64 || name.find_first_not_of(kCharacters) != std::string::npos)
    reader.complain(*reader.table().find("name"), "name", "1 to 64 letters, digits, _ - .");
}

RadarReading read_radar(SceneReading& reading, const ConfigNode& table) {
  RadarReading radar;
  read_sub_sections(reading.top, reading.complaints, radar);
  SectionReader reader(table, "radar", reading.complaints);
  read_name(reader, radar.config.name);
  read_parameters(reader, "radar", radar);
  read_sub_sections(reader, reading.complaints, radar);
  reader.finish();

  radar.config.finds_pixels &= radar.config.settings.frustum == FrustumKind::oblique;
  for (const FieldError& error : validate(radar.config)) {
    const auto at = radar.set_at.find(error.field);
    reading.complaints.add(at != radar.set_at.end() ? at->second : table.where, error);
  }
  if (radar.config.pose.height_reference == HeightReference::ellipsoid &&
      !radar.set_at.contains("antenna.geoid_undulation_m"))
    reading.complaints.add(radar.set_at.at("antenna.height_reference"),
                           {"antenna.geoid_undulation_m", "nothing with height_reference = \"ellipsoid\"",
                            "the geoid's height above the ellipsoid there, m"});
  return radar;
}

}  // namespace

std::vector<MissingPosition> read_radars(SceneReading& reading) {
  std::vector<MissingPosition> missing;
  const auto read_one = [&](const ConfigNode& table) {
    const RadarReading radar = read_radar(reading, table);
    std::vector<RadarConfig>& radars = reading.config.radars;
    if (std::ranges::find(radars, radar.config.name, &RadarConfig::name) != radars.end())
      reading.complaints.add(table.where, {"radar.name", "a second " + toml_string(radar.config.name),
                                           "a name of its own for each [[radar]]"});
    const bool no_latitude = !radar.set_at.contains("antenna.latitude_deg");
    const bool no_longitude = !radar.set_at.contains("antenna.longitude_deg");
    if (no_latitude || no_longitude) missing.push_back({radars.size(), no_latitude, no_longitude});
    radars.push_back(radar.config);
  };
  // apply_overrides has made a [radar] where there was none, but `radar = []` remains possible.
  reading.top.each_table("radar", read_one);
  if (reading.config.radars.empty() && reading.complaints.empty())
    reading.complaints.add(reading.config.path.string(),
                           {"radar", "an empty list", "at least one [[radar]]"});
  const int most = reading.config.server.max_radars;
  if (reading.config.radars.size() > static_cast<std::size_t>(most)) {
    reading.complaints.add(reading.config.path.string(),
                           {"radar", std::to_string(reading.config.radars.size()) + " radars",
                            "at most " + std::to_string(most) + " (server.max_radars)"});
  }
  return missing;
}

}  // namespace obliq
