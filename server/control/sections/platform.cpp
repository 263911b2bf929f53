#include "server/control/sections/platform.h"

#include <algorithm>
#include <memory>
#include <set>

#include "server/control/sections/section.h"

namespace obliq {
namespace {

constexpr std::string_view kAntenna = "antenna.";

std::string local_name(const Parameter& p) { return std::string(p.key.name.substr(kAntenna.size())); }

PlatformConfig read_platform(SceneReading& scene, const ConfigNode& table) {
  PlatformConfig platform;
  RadarConfig holder;
  SectionReader reader(table, "platform", scene.complaints);
  read_name(reader, "platform.name", platform.name);
  if (platform.name.empty())
    scene.complaints.add(table.where, {"platform.name", "nothing", "a name that radars ride on"});
  for (const Parameter* p : platform_parameters()) reader.read(local_name(*p), p->key, p->slot(holder));
  reader.demand("latitude_deg", "a latitude");
  reader.demand("longitude_deg", "a longitude");
  if (holder.pose.height_reference == HeightReference::ellipsoid)
    reader.demand("geoid_undulation_m", "the geoid's height above the ellipsoid there, m");
  reader.finish();
  platform.pose = holder.pose;
  platform.pose.bearing_deg = platform.pose.heading_deg;
  return platform;
}

}  // namespace

std::vector<const Parameter*> platform_parameters() {
  std::vector<const Parameter*> list;
  for (const Parameter& p : parameters())
    if (p.message == WireMessage::pose && !p.meaning.aim) list.push_back(&p);
  return list;
}

bool is_of_platform(const RadarConfig& radar, const Parameter& parameter) {
  return radar.platform && parameter.message == WireMessage::pose &&
         !parameter.wire_field.starts_with("tilt");
}

std::string platform_key(const Parameter& parameter) { return "platform." + local_name(parameter); }

void read_name(SectionReader& reader, std::string_view key, std::string& name) {
  constexpr std::string_view kCharacters =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-.";
  if (!reader.read("name", Key{key, ""}, &name)) return;
  if (name.empty() || name.size() > 64 || name.find_first_not_of(kCharacters) != std::string::npos)
    reader.complain(*reader.table().find("name"), "name", "1 to 64 letters, digits, _ - .");
}

void read_platforms(SceneReading& scene) {
  std::set<std::string> names;
  scene.top.each_table("platform", [&](const ConfigNode& table) {
    auto platform = std::make_shared<const PlatformConfig>(read_platform(scene, table));
    if (!names.insert(platform->name).second)
      scene.complaints.add(table.where, {"platform.name", "a second " + toml_string(platform->name),
                                         "a name of its own for each [[platform]]"});
    scene.config.platforms.push_back(std::move(platform));
  });
}

std::string printed_platforms(const SceneConfig& config) {
  std::string text;
  for (const auto& platform : config.platforms) {
    RadarConfig holder;
    holder.pose = platform->pose;
    text += "\n[[platform]]\nname = " + toml_string(platform->name) + "\n";
    for (const Parameter* p : platform_parameters()) {
      const Slot slot = p->slot(holder);
      text += printed_line(local_name(*p), toml_text(load(p->key, slot)), p->key.summary,
                           allowed_text(p->key, slot), Change::restart);
    }
  }
  return text;
}

void note_empty_platforms(SceneConfig& config) {
  for (const auto& platform : config.platforms)
    if (std::ranges::none_of(config.radars, [&](const RadarConfig& r) { return r.platform == platform; }))
      config.notes.push_back(
          "[[platform]] " + toml_string(platform->name) +
          " carries no radar, and is left out: radar.platform names what a radar rides on");
}

}  // namespace obliq
