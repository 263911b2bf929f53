#pragma once
// The tables of everything in a scene file that is no radar parameter: read at start, changed by a restart.
#include <span>

#include "server/control/row.h"
#include "server/control/scene_config.h"

namespace obliq {

/// One key of a T: what it accepts and where it lives.
template <class T>
struct Entry {
  Key key;
  Slot (*slot)(T&);
};

/// Scalar keys of the sections; Key::name is the full dotted name.
std::span<const Row<SceneConfig>> scene_entries();

/// The sections that only the daemon reads, each with its keys among scene_entries().
std::span<const std::string_view> daemon_sections();

/// Keys of one [[buildings]], [[prisms]], [[surfaces]] or [materials.NAME] table; Key::name is local.
/// A material's gamma_db is kept in decibel here: it goes through MaterialKeys.
struct MaterialKeys {
  Material material;
  double gamma_db = 0;
};
std::span<const Row<BuildingSourceSpec>> building_entries();
std::span<const Row<PrismSpec>> prism_entries();
std::span<const Row<SurfaceSpec>> surface_entries();
std::span<const Row<MaterialKeys>> material_entries();

/// Keys that need more than a slot, for the reference page and for near names.
struct SpecialKey {
  std::string_view name;
  std::string_view allowed;
  std::string_view default_text;
  std::string_view summary;
};
std::span<const SpecialKey> special_keys();

/// Names of terrain.unit, in the order of VerticalUnit.
std::span<const Choice> vertical_units();

}  // namespace obliq
