// What `obliq explain` says of the scene's targets.
#include <cmath>
#include <string>

#include "server/explain/detection.h"
#include "server/explain/explanation.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/targets/target_echoes.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr std::size_t kMostTold = 8;
constexpr double kFalseAlarm = 1e-6;
constexpr double kProbability = 0.9;

}  // namespace

std::vector<ReportRow> target_rows(const FramePlan& plan, const AirView& air, const ExplainInput& input) {
  const TargetSet& targets = *input.targets;
  const std::vector<std::string>& names = input.target_names;
  const RadarSettings& s = plan.settings();
  TargetLook look;
  look.truth = true;
  const TargetEchoes echoes(plan, air, targets, {0, s.azimuth_bins}, look);
  RadarSettings noisy = s;
  noisy.receiver.noise = true;
  const double noise_w = noise_power_w(noisy, air);
  std::vector<ReportRow> rows;
  for (const TargetTruth& truth : echoes.truth()) {
    if (rows.size() == kMostTold) break;
    std::size_t k = 0;
    while (targets.targets[k].id != truth.id) ++k;
    const double rcs_m2 = ratio_of_db(targets.targets[k].size.rcs_dbsm);
    // On the boresight, in free space.
    const auto snr_db = [&](double range_m) {
      return db_of_ratio(echo_power_w(s.power_w, s.gain_db, wavelength_at(s.frequency_ghz),
                                      s.receiver.loss_db, rcs_m2, range_m) /
                         noise_w);
    };
    const auto reach_km = [&](int swerling) {
      const double more_db = snr_db(truth.range_m) - detectable_snr_db(swerling, kProbability, kFalseAlarm);
      return truth.range_m / 1000 * std::pow(10.0, more_db / 40);
    };
    rows.push_back(
        {"target " + names[k],
         text_of(
             values("rcs"_is = rcs_m2, "range"_is = truth.range_m / 1000, "snr"_is = snr_db(truth.range_m),
                    "steady"_is = reach_km(0), "fluctuating"_is = reach_km(1), "share"_is = 100 * truth.share,
                    "hider"_is = name_of(truth.hidden_by)),
             {{"t", true,
               "{rcs:3} m^2 at {range:.2f} km: {snr:.2f} dB; Pd 0.9 to {steady:.1f} km (Swerling 0), "
               "{fluctuating:.1f} km (1). "},
              {"t", true, "Of one pulse on the boresight over receiver noise, Pfa 1e-6, in free space. "},
              {"t", truth.range_bin < 0, "It is beside the swath. "},
              {"t", truth.azimuth_bin < 0, "It is beside the sector. "},
              {"t", truth.share < 1, "{share:.0f} % of it is seen, hidden by {hider}. "}})});
    if (rows.back().text.ends_with(' ')) rows.back().text.pop_back();
  }
  return rows;
}

}  // namespace obliq
