#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "server/accuracy/thresholds.h"
#include "server/explain/explanation.h"
#include "server/explain/table.h"
#include "server/radar/echo/scattering.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {

namespace {

constexpr double kTenth_db = 0.1;
constexpr double kFurthestCell_m = 1e5;
constexpr double kFullContrast = 0.98;  ///< as near to 1 as a measured frame can tell

std::string k_text(double curvature) { return short_number(1 / curvature, 4); }

std::string within_swath(double range_m, double horizon, const SceneFacts& f) {
  if (range_m >= horizon) return fmt::format("anywhere this side of the horizon ({:.1f} km)", horizon / 1000);
  return range_m > f.settings.r_max_m ? fmt::format("up to {:.1f} km, beyond this swath", range_m / 1000)
                                      : fmt::format("only up to {:.1f} km", range_m / 1000);
}

/// Curvature and refraction: one earth against another.
std::string earth_threshold(const Comparison& c, const SceneFacts& f) {
  const double with = 1 / f.earth_factor;
  const double without = c.ingredient == Ingredient::curvature ? 0 : f.earth_factor == 1 ? 1 / c.value : 1;
  const double r = f.settings.r_max_m;
  const double h = f.height_m;
  std::string text;
  if (c.ingredient == Ingredient::curvature) {
    text = fmt::format(
        "drop r^2/(2kR), R = 6371 km: {:.1f} m at {} km with k = {}, {:.1f} m with k = 1 (parabola through "
        "the sphere). ",
        earth_drop_m(r, with), short_number(r / 1000, 4), k_text(with), earth_drop_m(r, 1));
  } else {
    text = fmt::format("drop r^2/(2kR) differs by {:.1f} m at {} km between k = {} and k = {}. ",
                       std::abs(earth_drop_m(r, with) - earth_drop_m(r, without)), short_number(r / 1000, 4),
                       k_text(with), k_text(without));
  }
  if (!(h > 0)) return text + "The antenna is not above its median ground: no level-ground threshold.";
  const double horizon = horizon_m(h, std::max(with, without));
  text += fmt::format(
      "Over level ground {:.0f} m below, a bin's power goes with 1 - r^2/(2kRh) (law of cosines; 0 at the "
      "horizon): below 0.1 dB {}; half a range bin ({} m) of slant range ",
      h, within_swath(range_of_power_change_m(h, with, without, kTenth_db), horizon, f),
      short_number(f.range_spacing_m / 2));
  const double moved = range_of_slant_shift_m(h, with, without, f.range_spacing_m / 2);
  return text + (moved >= horizon || moved > r ? "is never reached in this swath."
                                               : fmt::format("is reached at {:.1f} km.", moved / 1000));
}

double depression_rad(double height_m, double slant_m) {
  return std::asin(std::clamp(height_m / slant_m, 0.0, 1.0));
}

std::string cell_threshold(const Comparison& c, const SceneFacts& f) {
  std::string text;
  if (f.source_error.posts > 0) {
    text = fmt::format("cells of {} m lie {} m (95 %) off their source", short_number(f.cell_m, 4),
                       short_number(f.source_error.p95_m));
    if (c.source_error && c.source_error->posts > 0)
      text +=
          fmt::format(", cells of {} m {} m", short_number(c.value, 4), short_number(c.source_error->p95_m));
    text += ". ";
  }
  if (!(f.height_m > 0) || c.value < f.cell_m) return text;
  const double steepest = depression_rad(f.height_m, f.settings.r_min_m);
  const double allowed = vertical_tolerance_m(f.range_spacing_m / 2, steepest);
  text += fmt::format(
      "An error of {} m moves ground at r_min by half a range bin (bin/2 / sin depression, {:.1f} deg)",
      short_number(allowed), steepest / kDegree_rad);
  if (f.source_error.p95_m > 0 && c.source_error && c.source_error->p95_m > 0 && c.value > f.cell_m &&
      c.source_error->p95_m > f.source_error.p95_m) {
    const double order =
        std::log(c.source_error->p95_m / f.source_error.p95_m) / std::log(c.value / f.cell_m);
    const double reached_m = cell_of_error_m(f.cell_m, f.source_error.p95_m, order, allowed);
    // An error that hardly grows reaches it nowhere on this earth.
    if (reached_m < kFurthestCell_m)
      text += fmt::format("; the error grows as cell^{:.1f} here: reached by cells of {} m. ", order,
                          short_number(reached_m, 2));
    else
      text += "; larger cells do not reach it. ";
    return text + (c.power_counts ? "Slopes, and so single bins, suffer sooner: see the dB." : "");
  }
  return text + ".";
}

std::string wall_threshold(const SceneFacts& f) {
  if (!(f.height_m > 0) || !(f.sizes.side_m > 0)) return {};
  const double near = depression_rad(f.height_m, f.settings.r_min_m);
  const double far = depression_rad(f.height_m, f.settings.r_max_m);
  const double share = 1 - std::pow(10.0, -kTenth_db / 10);
  const double steep = depression_of_wall_share_rad(f.sizes.height_m, f.sizes.side_m, share);
  const ScatteringTable table(f.materials, 1);
  const auto facing_db = [&](double e) {
    const double wall = table.cross_section_m2(f.building_material, 1, std::cos(e));
    const double roof = table.cross_section_m2(f.building_material, 1, std::sin(e));
    return 10 * std::log10(wall / roof);
  };
  std::string text = fmt::format(
      "a building of median size ({} m high, {} m wide) shows H cos e / (H cos e + W sin e) of itself as "
      "wall: {:.0f} % at r_min (e = {:.1f} deg), {:.0f} % at r_max ({:.1f} deg). Walls give less than 0.1 dB "
      "only above e = {:.1f} deg{}. ",
      short_number(f.sizes.height_m), short_number(f.sizes.side_m),
      100 * wall_share(f.sizes.height_m, f.sizes.side_m, near), near / kDegree_rad,
      100 * wall_share(f.sizes.height_m, f.sizes.side_m, far), far / kDegree_rad, steep / kDegree_rad,
      steep > near ? ", steeper than this swath" : "");
  const double at_near = facing_db(near), at_far = facing_db(far);
  if (std::isfinite(at_near) && std::isfinite(at_far))
    text += fmt::format(
        "By its material a facing wall returns {:+.1f} dB at r_min and {:+.1f} dB at r_max against the roof, "
        "area for area.",
        at_near, at_far);
  return text;
}

std::string material_threshold(const Comparison& c, const SceneFacts& f) {
  const ScatteringTable table(f.materials, wavelength_at(f.settings.frequency_ghz));
  const double near = depression_rad(std::max(0.0, f.height_m), f.settings.r_min_m);
  const double far = depression_rad(std::max(0.0, f.height_m), f.settings.r_max_m);
  for (const std::uint8_t id : {c.material, std::uint8_t{0}})
    if (f.materials[id].model == ScatteringModel::flat_plate)
      return "none: the power of a flat plate (" + f.materials[id].name +
             ") goes with the square of the area of each piece that it is cut into.";
  const auto against_db = [&](double cos_incidence) {
    return 10 * std::log10(table.cross_section_m2(c.material, 1, cos_incidence) /
                           table.cross_section_m2(0, 1, cos_incidence));
  };
  // Level pieces are hit at 90 degrees less the depression, walls that face the radar at the depression.
  const double level_near = against_db(std::sin(near)), level_far = against_db(std::sin(far));
  const double wall_near = against_db(std::cos(near)), wall_far = against_db(std::cos(far));
  for (const double value : {level_near, level_far, wall_near, wall_far})
    if (!std::isfinite(value)) return {};
  const auto pair = [](double at_near, double at_far) {
    return fmt::format("{:+.1f} dB at r_min and {:+.1f} dB at r_max",
                       without_sign_of_zero(at_near, kTenth_db), without_sign_of_zero(at_far, kTenth_db));
  };
  std::string text = "level pieces of it return " + pair(level_near, level_far);
  if (c.on_buildings) text += ", facing walls " + pair(wall_near, wall_far) + ",";
  text += " against the terrain's material (sigma per projected area)";
  double greatest_db = std::max(std::abs(level_near), std::abs(level_far));
  if (c.on_buildings) greatest_db = std::max({greatest_db, std::abs(wall_near), std::abs(wall_far)});
  const std::string which = c.on_buildings ? "all four" : "both";
  if (greatest_db >= kTenth_db) return text + "; not needed where " + which + " are below 0.1 dB.";
  text += "; " + which + " are below 0.1 dB";
  return text + (c.verdict == Verdict::needed
                     ? ", so what was measured comes from tilted pieces, which this leaves out."
                     : ": not needed on level ground.");
}

std::string speckle_threshold(const Explanation& all) {
  const SpeckleMeasure& geometric = all.geometric_speckle;
  if (geometric.median_samples == 0) return "nothing sampled by this frustum: no contrast to measure.";
  return fmt::format(
      "contrast |v|^2/P: ground {:.2f}, geometric {:.2f} (fully developed: 1). Geometric speckle of n like "
      "samples has sqrt(1 - 1/n) (Goodman 2007, 3.2): {:.2f} from {:.0f} samples a bin on; here the median "
      "bin has {:.0f}.",
      all.ground_speckle.contrast, geometric.contrast, kFullContrast, 1 / (1 - kFullContrast * kFullContrast),
      geometric.median_samples);
}

std::string threshold(const Comparison& c, const Explanation& all) {
  switch (c.ingredient) {
    case Ingredient::curvature:
    case Ingredient::refraction:
      return earth_threshold(c, all.facts);
    case Ingredient::cell_size:
      return cell_threshold(c, all.facts);
    case Ingredient::walls:
      return wall_threshold(all.facts);
    case Ingredient::buildings:
      return {};
    case Ingredient::material:
      return material_threshold(c, all.facts);
    case Ingredient::speckle:
      return c.reason.empty() ? speckle_threshold(all) : "";
  }
  return {};
}

/// What the change saves: "saves 12 ms a frame, 40 MB", "costs ...", "saves nothing".
std::string saving(const Comparison& c, const Explanation& all) {
  const double saved_s = all.costs.frame_s - c.costs.frame_s;
  const double mb = (static_cast<double>(all.costs.bytes()) - static_cast<double>(c.costs.bytes())) / 1e6;
  std::string saves, costs;
  const auto add = [](std::string& to, const std::string& what) { to += (to.empty() ? "" : ", ") + what; };
  // Roofs without walls exist for this comparison alone, as triangles with gaps: no client gets that frame.
  if (c.ingredient != Ingredient::walls && std::abs(saved_s) > frame_repeats_within_s(all))
    add(saved_s > 0 ? saves : costs, fmt::format("{:.0f} ms a frame", 1000 * std::abs(saved_s)));
  if (std::abs(mb) >= std::max(0.5, 1e-8 * static_cast<double>(all.costs.bytes())))
    add(mb > 0 ? saves : costs, fmt::format("{:.0f} MB", std::abs(mb)));
  if (saves.empty() && costs.empty()) return "saves nothing";
  return (saves.empty() ? "" : "saves " + saves) + (saves.empty() || costs.empty() ? "" : " and ") +
         (costs.empty() ? "" : "costs " + costs);
}

/// "95 % of bins within 1.1 dB, 5.7 % of them off by more than 1 dB, total +0.02 dB, ground within 5.80 m".
std::string change_text(const Comparison& c) {
  const PowerChange& p = c.power;
  std::string text;
  if (!c.power_counts)
    text = "no verdict in power, see the flat plates above";
  else if (p.nothing_left())
    text = "no power is left";
  else
    text = fmt::format("95 % of bins within {} dB, {} % of them off by more than 1 dB, total {:+.2f} dB",
                       short_number(std::max(0.01, p.percentile95_db), 2), short_number(100 * p.over_1_db, 2),
                       without_sign_of_zero(p.total_db(), 0.01));
  if (c.shift) text += fmt::format(", ground within {:.2f} m of slant range", c.shift->slant_m);
  return text;
}

std::string words(const Comparison& c, const Explanation& all) {
  if (!c.reason.empty()) return "not measured: " + c.reason + ".";
  if (c.ingredient == Ingredient::speckle) {
    const bool ground = resolved_speckle(all.facts.settings) != SpeckleKind::geometric;
    return fmt::format(
        "{} where I&Q is used from pulse to pulse, since geometric follows the sampling; powers are the "
        "same: {} {}.",
        ground ? "ground speckle is needed" : "the scene has geometric speckle; ground is needed", c.change,
        saving(c, all));
  }
  const bool cell = c.ingredient == Ingredient::cell_size;
  const bool finer = cell && c.value < all.facts.cell_m;
  const std::string change = fmt::format(" ({}: {})", c.change, change_text(c));
  const std::string price = saving(c, all) + ".";
  const std::string mark = c.below_frustum_noise ? "*" : "";
  switch (c.verdict) {
    case Verdict::needed:
      if (finer) return fmt::format("finer cells would show{}{}; halving them {}", mark, change, price);
      if (c.adds) return fmt::format("needed{}, but this scene leaves it out{}.", mark, change);
      return fmt::format("needed{}{}{}{}", mark, change, cell ? "; doubling the cells " : "; leaving it out ",
                         price);
    case Verdict::not_needed:
      if (!c.power_counts)
        return "ground moves by less than half a range bin" + change + "; the change " + price;
      if (finer) return "finer cells are not needed" + change + "; halving them " + price;
      if (c.adds) return "may stay left out" + change + ".";
      return (cell ? "cells may be doubled" : "may be left out") + change + "; that " + price;
    case Verdict::beyond_measure:
      return fmt::format("below the sampling noise of this measurement{}; {}{}", change,
                         cell ? "the change " : "leaving it out ", price);
    case Verdict::not_measured:
      break;
  }
  return "not measured.";
}

struct Measure {
  double value, noticeable, noise;
};

}  // namespace

double frame_repeats_within_s(const Explanation& all) {
  double spread_s = all.costs.spread_s;
  for (const Comparison& c : all.comparisons) spread_s = std::max(spread_s, c.costs.spread_s);
  return std::ceil(1000 * std::max(all.costs.frame_s / 20, kAboveNoise * spread_s)) / 1000;
}

void judge(Comparison& c, const Explanation& all) {
  decide(c, all);
  c.threshold = threshold(c, all);
  c.advice = words(c, all);
}

void decide(Comparison& c, const Explanation& all) {
  if (!c.reason.empty()) return;
  // Another material changes no ray: nothing of it is noise.
  const PowerChange none;
  const PowerChange& noise = c.ingredient == Ingredient::material ? none
                             : c.ingredient == Ingredient::walls  ? all.wall_noise.value_or(none)
                                                                  : all.measurement_noise;
  const Measure measures[] = {
      {c.power.median_db, kNoticeableMedian_db, noise.median_db},
      {c.power.percentile95_db, kNoticeable95_db, noise.percentile95_db},
      {c.power.over_1_db, kNoticeableShare, noise.over_1_db},
      {c.power.vanished + c.power.appeared, kNoticeableShare, noise.vanished + noise.appeared},
      {std::abs(c.power.total_db()), kNoticeableTotal_db, std::abs(noise.total_db())},
      {c.shift ? c.shift->slant_m : 0, kNoticeableShift_bins * all.facts.range_spacing_m, 0},
  };
  c.verdict = Verdict::not_needed;
  for (const Measure& m : measures) {
    const bool of_power = &m != std::end(measures) - 1;
    if (of_power && !c.power_counts) continue;
    if (!(m.value >= m.noticeable)) continue;
    if (m.value > kAboveNoise * m.noise) {
      c.verdict = Verdict::needed;
      break;
    }
    c.verdict = Verdict::beyond_measure;
  }
  const PowerChange& frustum = all.frustum_noise;
  c.below_frustum_noise = frustum.nothing_left() || (c.power.median_db < frustum.median_db &&
                                                     c.power.percentile95_db < frustum.percentile95_db &&
                                                     c.power.over_1_db < frustum.over_1_db);
}

}  // namespace obliq
