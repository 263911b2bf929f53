#include "server/control/sections/radar_aliases.h"

#include <utility>

#include "server/control/parameters.h"

namespace obliq {
namespace {

/// From what a value comes: a flag beats a variable, and that the file.
int rank_of_source(const ConfigNode& node) {
  return node.layer == 0 ? 0 : node.where.starts_with("environment") ? 1 : 2;
}

}  // namespace

void read_aliases(SceneReading& scene, SectionReader& own, RadarConfig& radar,
                  std::map<std::string, std::string>& set_at) {
  for (const KeyAlias& each : kKeyAliases) {
    const std::string_view local = name_in("radar", each.alias);
    const ConfigNode* const here = own.take(local);
    if (here == nullptr) continue;
    const std::string_view section = each.name.substr(0, each.name.find('.'));
    const ConfigNode* there = nullptr;
    for (const SectionReader* holder : {&std::as_const(scene.top), &std::as_const(own)})
      if (const ConfigNode* table = holder->table().find(section))
        if (const ConfigNode* node = table->find(name_in(section, each.name))) there = node;
    if (there != nullptr && rank_of_source(*there) > rank_of_source(*here)) continue;
    if (there != nullptr && rank_of_source(*there) == rank_of_source(*here) && there->value != here->value)
      scene.complaints.add(here->where, {std::string(each.alias),
                                         here->found_text() + " beside " + std::string(each.name) + " = " +
                                             there->found_text(),
                                         std::string(kOneOfTwoNames)});
    const Parameter& parameter = *find_parameter(each.name);
    if (own.read_unchecked(local, parameter.key, parameter.slot(radar)))
      set_at[std::string(each.name)] = here->where;
  }
}

}  // namespace obliq
