#include "server/accuracy/truth_search.h"

#include <algorithm>

namespace obliq {
namespace {

constexpr const char* kReturnsNames[3] = {"all", "terrain", "buildings"};

/// The smaller of two errors where 0 means that there is none to speak of.
void take_smaller(double& smallest, double value) {
  if (value > 0 && (smallest == 0 || value < smallest)) smallest = value;
}

}  // namespace

void SmallestErrors::add(const FrameMeasurement& measured) {
  for (int k = 0; k < (measured.has_buildings ? 3 : 1); ++k) {
    const BinErrors& e = measured.errors[k].bins;
    take_smaller(smallest_[k].power_error, e.power_error);
    take_smaller(smallest_[k].median_db, e.median_db);
    take_smaller(smallest_[k].gap_fraction, e.gap_fraction());
    take_smaller(smallest_[k].false_light_fraction, e.false_light_fraction());
  }
}

std::vector<TruthCheck> SmallestErrors::check(const BinErrors (&own)[3], bool has_buildings) const {
  std::vector<TruthCheck> checks;
  for (int k = 0; k < (has_buildings ? 3 : 1); ++k) {
    const std::string of = std::string(", ") + kReturnsNames[k];
    checks.push_back({"E" + of, own[k].power_error, smallest_[k].power_error});
    checks.push_back({"median dB" + of, own[k].median_db, smallest_[k].median_db});
    checks.push_back({"gaps" + of, own[k].gap_fraction(), smallest_[k].gap_fraction});
    checks.push_back({"false light" + of, own[k].false_light_fraction(), smallest_[k].false_light_fraction});
  }
  return checks;
}

std::vector<TruthCheck> check_truth(const TruthBins& truth, const TruthBins& finer, const RangeBins& ranges,
                                    const SmallestErrors& smallest) {
  BinErrors own[3];
  for (int k = 0; k < 3; ++k) {
    const auto returns = static_cast<Returns>(k);
    own[k] = bin_errors(truth.power_w(returns), finer.power_w(returns), ranges);
  }
  return smallest.check(own, !truth.buildings.empty());
}

TruthQuality search_truth(const FramePlan& plan, const AzimuthRuns& probe, ReferenceSampling start,
                          int most_planes, const std::function<SmallestErrors(const TruthBins&)>& measure,
                          const Progress& progress) {
  const RangeBins ranges = range_bins(plan.settings());
  const auto truth = [&](const ReferenceSampling& sampling) {
    return integrate_truth(plan, probe, sampling, progress);
  };
  SmallestErrors smallest;
  const auto check = [&](const TruthBins& coarse, const TruthBins& fine) {
    return check_truth(coarse, fine, ranges, smallest);
  };
  const auto all_hold = [](const std::vector<TruthCheck>& checks) {
    return std::ranges::all_of(checks, &TruthCheck::holds);
  };

  TruthQuality quality{start, {}, probe, false};
  TruthBins here = truth(start);
  for (bool first = true;; first = false) {
    const TruthBins halved =
        truth({2 * quality.sampling.planes_per_bin, quality.sampling.step_m / 2, start.threads});
    if (first) smallest = measure(halved);
    quality.checks = check(here, halved);
    quality.holds = all_hold(quality.checks);
    if (quality.holds || 2 * quality.sampling.planes_per_bin > most_planes) return quality;
    // Nearly always the planes are too few, not the steps too long: halve those only where they alone fail.
    ReferenceSampling shorter = quality.sampling;
    shorter.step_m /= 2;
    if (!all_hold(check(here, truth(shorter)))) quality.sampling.step_m /= 2;
    quality.sampling.planes_per_bin *= 2;
    here = truth(quality.sampling);
  }
}

}  // namespace obliq
