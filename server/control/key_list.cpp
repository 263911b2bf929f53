#include "server/control/key_list.h"

#include "server/control/parameters.h"
#include "server/control/sections/materials.h"
#include "server/control/sections/platform.h"
#include "server/control/sections/section.h"
#include "server/control/sections/sources.h"
#include "server/control/sections/targets.h"

namespace obliq {
namespace {

template <class T>
void add(std::vector<KeyText>& list, KeyGroup group, const std::string& prefix, const Keys<T>& keys) {
  T defaults;
  SceneConfig scene;
  scene.materials = shipped_materials();
  for (const auto& [key, form, read, print, default_text, change] : keys.special) {
    const std::string value = default_text.empty() ? print(defaults, scene) : std::string(default_text);
    list.push_back({group, prefix + std::string(key.name), key, key.choices.empty() ? "other" : "choice",
                    value, allowed_text(key, form), change, nullptr, true});
  }
  for (const auto& [key, slot, change] : keys.rows)
    list.push_back({group, prefix + std::string(key.name), key, std::string(type_name(slot(defaults))),
                    toml_text(load(key, slot(defaults))), allowed_text(key, slot(defaults)), change});
}

template <class T>
void add(std::vector<KeyText>& list, const ListSection<T>& section) {
  add(list, KeyGroup::list, std::string(section.name) + ".", section.keys);
}

}  // namespace

std::vector<KeyText> all_keys() {
  std::vector<KeyText> list;
  RadarConfig radar;
  for (const Parameter& p : parameters()) {
    const Slot slot = p.slot(radar);
    list.push_back({KeyGroup::radar, std::string(p.key.name), p.key, std::string(type_name(slot)),
                    toml_text(load(p.key, slot)), allowed_text(p.key, slot), p.change, &p});
  }
  add<RadarConfig>(list, KeyGroup::short_form, "", {mount_rows(), radar_special_keys()});
  for (const Section* section : sections()) add(list, KeyGroup::section, "", section->keys);
  add(list, kBuildings);
  add(list, kPrisms);
  add(list, kSurfaces);
  for (const Parameter* p : platform_parameters()) {
    const Slot slot = p->slot(radar);
    list.push_back({KeyGroup::list, platform_key(*p), p->key, std::string(type_name(slot)),
                    toml_text(load(p->key, slot)), allowed_text(p->key, slot), Change::restart});
  }
  add<TargetType>(list, KeyGroup::list, "target_types.NAME.", target_type_keys());
  add<Target>(list, KeyGroup::list, "target.", {target_rows()});
  add<TargetConfig>(list, KeyGroup::list, "target.", {target_config_rows()});
  add<RoutePoint>(list, KeyGroup::list, "target.route.", {route_rows()});
  add<MaterialKeys>(list, KeyGroup::material, "materials.NAME.", {material_rows(), material_special_keys()});
  return list;
}

std::vector<std::string> names_of_flags() {
  std::vector<std::string> names;
  for (const KeyText& key : all_keys())
    if (key.group != KeyGroup::list && key.group != KeyGroup::material) names.push_back(key.name);
  return names;
}

}  // namespace obliq
