#include "server/explain/verdict.h"

#include <cmath>
#include <iterator>

namespace obliq {
namespace {

struct Measure {
  double value, noticeable, noise;
};

}  // namespace

void decide(Comparison& c, const Explanation& all) {
  if (!c.reason.empty()) return;
  // Another material changes no ray: nothing of it is noise.
  const PowerChange none;
  const PowerChange& noise = c.ingredient == Ingredient::material ? none
                             : c.ingredient == Ingredient::walls  ? all.wall_noise
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
