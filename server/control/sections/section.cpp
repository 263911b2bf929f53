#include "server/control/sections/section.h"

#include <algorithm>
#include <array>

#include "server/control/sections/sources.h"
#include "server/control/sections/targets.h"

namespace obliq {
namespace {

constexpr std::array<const Section*, 12> kSections{
    &kTerrainSection, &kShapeSection, &kEarthSection, &kAccuracySection, &kRunSection,    &kServerSection,
    &kStreamSection,  &kHttpSection,  &kLogSection,   &kFlightSection,   &kModbusSection, &kTargetsSection};

void read_section(SceneReading& scene, SectionReader& holder, const Section& section) {
  const std::string name(section.name.substr(section.name.rfind('.') + 1));
  const auto read_table = [&](const ConfigNode& table) {
    SectionReader reader(table, std::string(section.name), scene.complaints);
    read_keys(scene, reader, section.keys, section.name, scene.config);
    for (const Section* inner : kSections)
      if (!name_in(section.name, inner->name).empty()) read_section(scene, reader, *inner);
    if (section.finish != nullptr) section.finish(scene, reader);
    reader.finish();
  };
  ConfigNode nothing;
  nothing.where = scene.config.path.string();
  if (holder.table().find(name) != nullptr) {
    holder.one_table(name, read_table);
  } else {
    holder.take(name);
    read_table(nothing);
  }
}

}  // namespace

const std::string* FoundKey::text() const {
  const auto* text = std::get_if<std::string>(&node.value);
  return node.kind == ConfigNode::Kind::value && text != nullptr && !text->empty() ? text : nullptr;
}

std::span<const Section* const> sections() { return kSections; }

std::span<const Row<SceneConfig>> scene_rows() {
  static const auto all = [] {
    std::vector<Row<SceneConfig>> rows;
    for (const Section* section : kSections)
      rows.insert(rows.end(), section->keys.rows.begin(), section->keys.rows.end());
    return rows;
  }();
  return all;
}

std::string allowed_text(const Key& key, std::string_view form) {
  std::string text(form);
  const std::string limits =
      key.choices.empty() ? limits_text(key.limits, key.unit) : choices_text(key.choices);
  if (limits != "any") text += (text.empty() ? "" : " ") + limits;
  return text;
}

std::string printed_line(std::string_view name, const std::string& value, std::string_view summary,
                         const std::string& allowed, Change change) {
  std::string text = toml_key(name) + " = " + value;
  if (text.size() < 32) text.append(32 - text.size(), ' ');
  return text + "  # " + std::string(summary) + " [" + allowed + "; " + std::string(change_name(change)) +
         "]\n";
}

std::string_view name_in(std::string_view prefix, std::string_view name) {
  if (prefix.empty()) return name;
  if (name.size() <= prefix.size() || !name.starts_with(prefix) || name[prefix.size()] != '.') return {};
  name.remove_prefix(prefix.size() + 1);
  return name.find('.') == std::string_view::npos ? name : std::string_view();
}

void read_sections(SceneReading& scene) {
  for (const Section* section : kSections)
    if (section->name.find('.') == std::string_view::npos) read_section(scene, *section);
}

void read_section(SceneReading& scene, const Section& section) { read_section(scene, scene.top, section); }

std::string printed_sections(const SceneConfig& config) {
  std::string text;
  for (const Section* section : kSections) {
    if (section == &kShapeSection && config.world.terrain.synthetic == SyntheticKind::none) continue;
    text += "\n[" + std::string(section->name) + "]\n" +
            printed_keys(section->keys, section->name, config, config);
  }
  return text;
}

}  // namespace obliq
