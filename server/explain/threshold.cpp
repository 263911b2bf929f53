// From where on each ingredient matters.
#include <algorithm>
#include <cmath>

#include "server/accuracy/thresholds.h"
#include "server/explain/explanation.h"
#include "server/radar/echo/scattering.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kTenth_db = 0.1;

/// Curvature and refraction: one earth against another.
std::string earth(const Comparison& c, const Explanation& all) {
  const SceneFacts& f = all.facts;
  const bool curvature = c.ingredient == Ingredient::curvature;
  const double with = 1 / f.earth_factor;
  const double without = curvature ? 0 : f.earth_factor == 1 ? 1 / c.value : 1;
  const double r = f.settings.r_max_m, h = f.height_m;
  const double horizon = horizon_m(h, std::max(with, without));
  const double faint = range_of_power_change_m(h, with, without, kTenth_db);
  const double moved = range_of_slant_shift_m(h, with, without, f.range_spacing_m / 2);
  return text_of(
      values("drop_m"_is = earth_drop_m(r, with), "vacuum_m"_is = earth_drop_m(r, 1),
             "apart_m"_is = std::abs(earth_drop_m(r, with) - earth_drop_m(r, without)),
             "r_max_km"_is = r / 1000, "k"_is = 1 / with, "other_k"_is = 1 / without, "height_m"_is = h,
             "horizon_km"_is = horizon / 1000, "faint_km"_is = faint / 1000,
             "half_bin_m"_is = f.range_spacing_m / 2, "moved_km"_is = moved / 1000),
      {{"earth", curvature,
        "drop r^2/(2kR), R = 6371 km: {drop_m:.1f} m at {r_max_km:4} km with k = {k:4}, {vacuum_m:.1f} m "
        "with "
        "k = 1 (parabola through the sphere). "},
       {"earth", !curvature,
        "drop r^2/(2kR) differs by {apart_m:.1f} m at {r_max_km:4} km between k = {k:4} and k = "
        "{other_k:4}. "},
       {"earth", !(h > 0), "The antenna is not above its median ground: no level-ground threshold."},
       {"earth", h > 0,
        "Over level ground {height_m:.0f} m below, a bin's power goes with 1 - r^2/(2kRh) (law of cosines; 0 "
        "at "
        "the horizon): below 0.1 dB "},
       {"earth", h > 0,
        faint >= horizon ? "anywhere this side of the horizon ({horizon_km:.1f} km)"
        : faint > r      ? "up to {faint_km:.1f} km, beyond this swath"
                         : "only up to {faint_km:.1f} km"},
       {"earth", h > 0, "; half a range bin ({half_bin_m:3} m) of slant range "},
       {"earth", h > 0,
        moved >= horizon || moved > r ? "is never reached in this swath."
                                      : "is reached at {moved_km:.1f} km."}});
}

double depression_rad(double height_m, double slant_m) {
  return std::asin(std::clamp(height_m / slant_m, 0.0, 1.0));
}

std::string cell(const Comparison& c, const Explanation& all) {
  constexpr double kFurthestCell_m = 1e5;  // an error that hardly grows reaches it nowhere on this earth
  const SceneFacts& f = all.facts;
  const SourceError changed = c.source_error.value_or(SourceError{});
  const bool known = f.source_error.posts > 0, both = known && changed.posts > 0;
  const bool coarser = f.height_m > 0 && c.value >= f.cell_m;
  const double steepest = depression_rad(f.height_m, f.settings.r_min_m);
  const double allowed = vertical_tolerance_m(f.range_spacing_m / 2, steepest);
  const double own_m = f.source_error.p95_m;
  const bool grows = coarser && own_m > 0 && c.value > f.cell_m && changed.p95_m > own_m;
  const double order = std::log(changed.p95_m / own_m) / std::log(c.value / f.cell_m);
  const double reached_m = cell_of_error_m(f.cell_m, own_m, order, allowed);
  return text_of(
      values("cell_m"_is = f.cell_m, "own_m"_is = own_m, "other_cell_m"_is = c.value,
             "other_m"_is = changed.p95_m, "allowed_m"_is = allowed,
             "steepest_deg"_is = steepest / kDegree_rad, "order"_is = order, "reached_m"_is = reached_m),
      {{"cell", known, "cells of {cell_m:4} m lie {own_m:3} m (95 %) off their source"},
       {"cell", both, ", cells of {other_cell_m:4} m {other_m:3} m"},
       {"cell", known, ". "},
       {"cell", coarser,
        "An error of {allowed_m:3} m moves ground at r_min by half a range bin (bin/2 / sin depression, "
        "{steepest_deg:.1f} deg)"},
       {"cell", grows && reached_m < kFurthestCell_m,
        "; the error grows as cell^{order:.1f} here: reached by cells of {reached_m:2} m. "},
       {"cell", grows && !(reached_m < kFurthestCell_m), "; larger cells do not reach it. "},
       {"cell", grows && c.power_counts, "Slopes, and so single bins, suffer sooner: see the dB."},
       {"cell", coarser && !grows, "."}});
}

std::string walls(const Comparison&, const Explanation& all) {
  const SceneFacts& f = all.facts;
  if (!(f.height_m > 0) || !(f.sizes.side_m > 0)) return {};
  const double near = depression_rad(f.height_m, f.settings.r_min_m);
  const double far = depression_rad(f.height_m, f.settings.r_max_m);
  const double share = 1 - std::pow(10.0, -kTenth_db / 10);
  const double steep = depression_of_wall_share_rad(f.sizes.height_m, f.sizes.side_m, share);
  const ScatteringTable table(f.materials, 1);
  const auto facing_db = [&](double e) {
    return 10 * std::log10(table.cross_section_m2(f.building_material, 1, std::cos(e)) /
                           table.cross_section_m2(f.building_material, 1, std::sin(e)));
  };
  const double near_db = facing_db(near), far_db = facing_db(far);
  return text_of(values("high_m"_is = f.sizes.height_m, "wide_m"_is = f.sizes.side_m,
                        "near"_is = 100 * wall_share(f.sizes.height_m, f.sizes.side_m, near),
                        "far"_is = 100 * wall_share(f.sizes.height_m, f.sizes.side_m, far),
                        "near_deg"_is = near / kDegree_rad, "far_deg"_is = far / kDegree_rad,
                        "steep_deg"_is = steep / kDegree_rad, "near_db"_is = near_db, "far_db"_is = far_db),
                 {{"walls", true,
                   "a building of median size ({high_m:3} m high, {wide_m:3} m wide) shows H cos e / (H cos "
                   "e + W sin e) "
                   "of itself as wall: {near:.0f} % at r_min (e = {near_deg:.1f} deg), {far:.0f} % at r_max "
                   "({far_deg:.1f} deg). Walls give less than 0.1 dB only above e = {steep_deg:.1f} deg"},
                  {"walls", steep > near, ", steeper than this swath"},
                  {"walls", true, ". "},
                  {"walls", std::isfinite(near_db) && std::isfinite(far_db),
                   "By its material a facing wall returns {near_db:+.1f} dB at r_min and {far_db:+.1f} dB at "
                   "r_max against "
                   "the roof, area for area."}});
}

std::string material(const Comparison& c, const Explanation& all) {
  const SceneFacts& f = all.facts;
  for (const std::uint8_t id : {c.material, std::uint8_t{0}})
    if (f.materials[id].model == ScatteringModel::flat_plate)
      return "none: the power of a flat plate (" + f.materials[id].name +
             ") goes with the square of the area of each piece that it is cut into.";
  const ScatteringTable table(f.materials, wavelength_at(f.settings.frequency_ghz));
  const double near = depression_rad(std::max(0.0, f.height_m), f.settings.r_min_m);
  const double far = depression_rad(std::max(0.0, f.height_m), f.settings.r_max_m);
  const auto against_db = [&](double cos_incidence) {
    return 10 * std::log10(table.cross_section_m2(c.material, 1, cos_incidence) /
                           table.cross_section_m2(0, 1, cos_incidence));
  };
  // Level pieces are hit at 90 degrees less the depression, walls that face the radar at the depression.
  const double level[] = {against_db(std::sin(near)), against_db(std::sin(far))};
  const double wall[] = {against_db(std::cos(near)), against_db(std::cos(far))};
  for (const double value : {level[0], level[1], wall[0], wall[1]})
    if (!std::isfinite(value)) return {};
  double greatest_db = std::max(std::abs(level[0]), std::abs(level[1]));
  if (c.on_buildings) greatest_db = std::max({greatest_db, std::abs(wall[0]), std::abs(wall[1])});
  const bool faint = greatest_db < kTenth_db;
  return text_of(
      values("level_near"_is = level[0], "level_far"_is = level[1], "wall_near"_is = wall[0],
             "wall_far"_is = wall[1], "which"_is = c.on_buildings ? "all four" : "both"),
      {{"material", true,
        "level pieces of it return {level_near:+.1f} dB at r_min and {level_far:+.1f} dB at r_max"},
       {"material", c.on_buildings,
        ", facing walls {wall_near:+.1f} dB at r_min and {wall_far:+.1f} dB at r_max,"},
       {"material", true, " against the terrain's material (sigma per projected area); "},
       {"material", !faint, "not needed where {which} are below 0.1 dB."},
       {"material", faint, "{which} are below 0.1 dB"},
       {"material", faint,
        c.verdict == Verdict::needed
            ? ", so what was measured comes from tilted pieces, which this leaves out."
            : ": not needed on level ground."}});
}

std::string speckle(const Comparison& c, const Explanation& all) {
  constexpr double kFull = 0.98;  // as near to a contrast of 1 as a measured frame can tell
  const double samples = all.geometric_speckle.median_samples;
  return text_of(
      values("ground"_is = all.ground_speckle.contrast, "full"_is = kFull,
             "geometric"_is = all.geometric_speckle.contrast, "many"_is = 1 / (1 - kFull * kFull),
             "samples"_is = samples),
      {{"speckle", c.reason.empty() && samples == 0,
        "nothing sampled by this frustum: no contrast to measure."},
       {"speckle", c.reason.empty() && samples > 0,
        "contrast |v|^2/P: ground {ground:.2f}, geometric {geometric:.2f} (fully developed: 1). "
        "Geometric speckle of n like samples has sqrt(1 - 1/n) (Goodman 2007, 3.2): {full:.2f} from "
        "{many:.0f} samples a bin on; here the median bin has {samples:.0f}."}});
}

struct Threshold {
  Ingredient of;
  std::string (*text)(const Comparison& comparison, const Explanation& all);
};
constexpr Threshold kThresholds[] = {
    {Ingredient::curvature, earth}, {Ingredient::refraction, earth},  {Ingredient::cell_size, cell},
    {Ingredient::walls, walls},     {Ingredient::material, material}, {Ingredient::speckle, speckle},
};

}  // namespace

std::string threshold_text(const Comparison& c, const Explanation& all) {
  const auto row = std::ranges::find(kThresholds, c.ingredient, &Threshold::of);
  return row != std::end(kThresholds) ? row->text(c, all) : "";
}

}  // namespace obliq
