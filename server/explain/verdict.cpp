// Whether an ingredient is needed, and what leaving it out saves.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/explain/explanation.h"

namespace obliq {
namespace {

/// A change counts when it reaches any of these. A tenth of a decibel and half a range bin are what
/// thresholds are worked out for; a radar that is calibrated to a decibel is a good one.
struct Limit {
  double (*of)(const PowerChange& change);
  double noticeable;
};
constexpr Limit kLimits[] = {
    {[](const PowerChange& p) { return p.median_db; }, 0.1},
    {[](const PowerChange& p) { return p.percentile95_db; }, 1},
    {[](const PowerChange& p) { return p.over_1_db; }, kNoticeableShare},
    {[](const PowerChange& p) { return p.vanished + p.appeared; }, kNoticeableShare},
    {[](const PowerChange& p) { return std::abs(p.total_db()); }, 0.1},
};
constexpr double kNoticeableShift_bins = 0.5;  ///< range bins

/// A change must be this much larger than the measurement's own noise to be told from it.
constexpr double kAboveNoise = 2;

/// What the change saves: "saves 12 ms a frame, 40 MB", "costs ...", "saves nothing".
std::string saving(const Comparison& c, const Explanation& all) {
  std::string saves, costs;
  const auto add = [&](double saved, double least, const char* unit) {
    if (!(std::abs(saved) >= least)) return;
    std::string& to = saved > 0 ? saves : costs;
    to += (to.empty() ? "" : ", ") + number_text(std::abs(saved), ".0f") + unit;
  };
  // Roofs without walls exist for this comparison alone, as triangles with gaps: no client gets that frame.
  const double saved_s = c.ingredient != Ingredient::walls ? all.costs.frame_s - c.costs.frame_s : 0;
  if (std::abs(saved_s) > frame_repeats_within_s(all)) add(1000 * saved_s, 0, " ms a frame");
  const auto own_bytes = static_cast<double>(all.costs.bytes());
  add((own_bytes - static_cast<double>(c.costs.bytes())) / 1e6, std::max(0.5, 1e-8 * own_bytes), " MB");
  if (saves.empty() && costs.empty()) return "saves nothing";
  return (saves.empty() ? "" : "saves " + saves) + (saves.empty() || costs.empty() ? "" : " and ") +
         (costs.empty() ? "" : "costs " + costs);
}

/// "95 % of bins within 1.1 dB, 5.7 % of them off by more than 1 dB, total +0.02 dB, ground within 5.80 m of
/// slant range".
std::string change_text(const Comparison& c) {
  const PowerChange& p = c.power;
  const bool left = !p.nothing_left();
  return text_of(
      values("percentile95_db"_is = std::max(0.01, p.percentile95_db), "over_1_db"_is = 100 * p.over_1_db,
             "total_db"_is = p.total_db(), "slant_m"_is = c.shift.value_or(GroundShift{}).slant_m),
      {{"", !c.power_counts, "no verdict in power, see the flat plates above"},
       {"", c.power_counts && !left, "no power is left"},
       {"", c.power_counts && left,
        "95 % of bins within {percentile95_db:2} dB, {over_1_db:2} % of them off by more than 1 dB, "
        "total {total_db:+.2f} dB"},
       {"", c.shift.has_value(), ", ground within {slant_m:.2f} m of slant range"}});
}

std::string advice(const Comparison& c, const Explanation& all) {
  const bool cell = c.ingredient == Ingredient::cell_size;
  const bool finer = cell && c.value < all.facts.cell_m;
  const bool is_ground = resolved_speckle(all.facts.settings) != SpeckleKind::geometric;
  // The first row whose verdict and condition hold.
  const struct {
    Verdict verdict;
    bool when;
    const char* text;
  } rows[] = {
      {c.verdict, !c.reason.empty(), "not measured: {reason}."},
      {c.verdict, c.ingredient == Ingredient::speckle,
       "{speckle} where I&Q is used from pulse to pulse, since geometric follows the sampling; powers are "
       "the "
       "same: {to} {saves}."},
      {Verdict::needed, finer, "finer cells would show{star} ({to}: {change}); halving them {saves}."},
      {Verdict::needed, c.adds, "needed{star}, but this scene leaves it out ({to}: {change})."},
      {Verdict::needed, cell, "needed{star} ({to}: {change}); doubling the cells {saves}."},
      {Verdict::needed, true, "needed{star} ({to}: {change}); leaving it out {saves}."},
      {Verdict::not_needed, !c.power_counts,
       "ground moves by less than half a range bin ({to}: {change}); the change {saves}."},
      {Verdict::not_needed, finer, "finer cells are not needed ({to}: {change}); halving them {saves}."},
      {Verdict::not_needed, c.adds, "may stay left out ({to}: {change})."},
      {Verdict::not_needed, cell, "cells may be doubled ({to}: {change}); that {saves}."},
      {Verdict::not_needed, true, "may be left out ({to}: {change}); that {saves}."},
      {Verdict::beyond_measure, cell,
       "below the sampling noise of this measurement ({to}: {change}); the change {saves}."},
      {Verdict::beyond_measure, true,
       "below the sampling noise of this measurement ({to}: {change}); leaving it out {saves}."},
      {c.verdict, true, "not measured."},
  };
  const auto row =
      std::ranges::find_if(rows, [&](const auto& r) { return r.verdict == c.verdict && r.when; });
  return text_of(values("reason"_is = c.reason, "to"_is = c.change, "change"_is = change_text(c),
                        "saves"_is = saving(c, all), "star"_is = c.below_frustum_noise ? "*" : "",
                        "speckle"_is = is_ground ? "ground speckle is needed"
                                                 : "the scene has geometric speckle; ground is needed"),
                 {{"", true, row->text}});
}

}  // namespace

double frame_repeats_within_s(const Explanation& all) {
  double spread_s = all.costs.spread_s;
  for (const Comparison& c : all.comparisons) spread_s = std::max(spread_s, c.costs.spread_s);
  return std::ceil(1000 * std::max(all.costs.frame_s / 20, kAboveNoise * spread_s)) / 1000;
}

void judge(Comparison& c, const Explanation& all) {
  decide(c, all);
  c.threshold = threshold_text(c, all);
  c.advice = advice(c, all);
}

void decide(Comparison& c, const Explanation& all) {
  if (!c.reason.empty()) return;
  // Another material changes no ray: nothing of it is noise.
  const PowerChange none;
  const PowerChange& noise = c.ingredient == Ingredient::material ? none
                             : c.ingredient == Ingredient::walls  ? all.wall_noise.value_or(none)
                                                                  : all.measurement_noise;
  c.verdict = Verdict::not_needed;
  const auto weigh = [&](double value, double noticeable, double noise_value) {
    if (c.verdict == Verdict::needed || !(value >= noticeable)) return;
    c.verdict = value > kAboveNoise * noise_value ? Verdict::needed : Verdict::beyond_measure;
  };
  if (c.power_counts)
    for (const Limit& limit : kLimits) weigh(limit.of(c.power), limit.noticeable, limit.of(noise));
  if (c.shift) weigh(c.shift->slant_m, kNoticeableShift_bins * all.facts.range_spacing_m, 0);
  const PowerChange& frustum = all.frustum_noise;
  c.below_frustum_noise = frustum.nothing_left() || (c.power.median_db < frustum.median_db &&
                                                     c.power.percentile95_db < frustum.percentile95_db &&
                                                     c.power.over_1_db < frustum.over_1_db);
}

}  // namespace obliq
