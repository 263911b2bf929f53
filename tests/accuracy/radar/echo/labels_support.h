#pragma once
// What the tests of labels share: every way to make bins, a town of four materials, frames with labels.
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "server/radar/frame_plan.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"

namespace obliq::test {

/// Every way to make bins.
struct Way {
  const char* name;
  FrustumKind frustum = FrustumKind::sweep;
  int sub_columns = 64;
  PlateKind plates = PlateKind::spread;
  bool beam = false;
  double azimuth_deg = 0.4;

  RadarSettings settings() const {
    RadarSettings s;
    s.frustum = frustum;
    s.sub_columns = sub_columns;
    s.plates = plates;
    s.r_min_m = 1200;
    s.r_max_m = 6000;
    s.azimuth_bins = 48;
    s.sector_deg = azimuth_deg * s.azimuth_bins;
    s.range_bins = 160;
    s.pixel_columns = frustum == FrustumKind::sweep ? 2 * s.azimuth_bins : 480;
    s.pixel_rows = 400;
    if (!beam) return s;
    s.beam.pattern = BeamPattern::gaussian;
    s.beam.width_deg = 1.2;
    s.pulse.kind = PulseKind::rectangular;
    s.pulse.length_us = 0.4;
    return s;
  }
};
inline void PrintTo(const Way& way, std::ostream* out) { *out << way.name; }

inline const Way kWays[] = {{"sweep"},
                            {"sweep_behind_a_beam", FrustumKind::sweep, 64, PlateKind::spread, true},
                            {"wide_bins", FrustumKind::sweep, 64, PlateKind::spread, false, 1.5},
                            {"exact_sweep", FrustumKind::sweep, 0},
                            {"exact_sweep_behind_a_beam", FrustumKind::sweep, 0, PlateKind::spread, true},
                            {"oblique", FrustumKind::oblique},
                            {"oblique_behind_a_beam", FrustumKind::oblique, 0, PlateKind::spread, true},
                            {"symmetric_nearest", FrustumKind::symmetric, 0, PlateKind::nearest}};

inline constexpr double kLabelHeight_m = 450;

inline Frame labelled(const std::shared_ptr<const Scene>& scene, const RadarSettings& s,
                      RenderOptions options = {}, double bearing_deg = 20) {
  options.labels = true;
  return render(scene, snapshot(s), pose_over_origin(scene->world(), kLabelHeight_m, bearing_deg),
                {0, s.azimuth_bins}, options);
}

inline void expect_same_labels(const Labels& a, const Labels& b) {
  EXPECT_TRUE(same_bits(a.material, b.material)) << "material";
  EXPECT_TRUE(same_bits(a.building, b.building)) << "building";
  EXPECT_TRUE(same_bits(a.height_m, b.height_m)) << "height";
  EXPECT_TRUE(same_bits(a.returns, b.returns)) << "returns";
}

/// Hills with houses, three materials of ground in stripes, and a fourth of houses; scaled: gamma by
/// material. wind: whether the second stripe moves in it.
inline std::shared_ptr<const Scene> striped_town(const std::vector<double>& scaled = {1, 1, 1, 1},
                                                 bool wind = false) {
  static const World town = [] {
    WorldSpec spec = synthetic_spec(SyntheticKind::hills, 7000, 30);
    spec.terrain.shape.height_m = 150;
    spec.radius_factor = 4.0 / 3;
    PrismSpec houses;
    houses.per_km2 = 60;
    spec.prisms = {houses};
    World world = load_world(spec);
    for (Building& building : world.buildings.list) building.material = 3;
    for (int j = 0; j + 1 < world.grid.nz; ++j)
      for (int i = 0; i + 1 < world.grid.nx; ++i)
        world.surface_material.push_back(static_cast<std::uint8_t>((i / 7 + j / 11) % 3));
    return world;
  }();
  std::vector<Material> materials(4);
  for (std::size_t k = 0; k < 4; ++k) {
    materials[k].name = "m" + std::to_string(k);
    materials[k].gamma = (0.1 + 0.05 * static_cast<double>(k)) * scaled[k];
  }
  materials[2].model = ScatteringModel::geometric_optics;
  materials[2].reflectivity = 0.3 * scaled[2];
  materials[1].wind = wind;
  return make_scene(town, materials, RayMethod::march);
}

}  // namespace obliq::test
