#pragma once
// How finely the truth has to be integrated: its own error, from halving its steps, is to be at most a tenth
// of the smallest error that is shown (PAPER.md, definitions).
#include <functional>
#include <string>
#include <vector>

#include "server/accuracy/measure_frame.h"

namespace obliq {

/// One measure of one part of the returns: what is shown, and how far the truth itself is from its halved
/// step.
struct TruthCheck {
  std::string measure;  ///< "E, terrain"
  double own = 0;       ///< of the truth
  double smallest = 0;  ///< of all frames shown; 0: nothing to compare with, and nothing asked
  bool holds() const { return smallest <= 0 || own <= kShare * smallest; }

  static constexpr double kShare = 0.1;
};

/// Smallest values over frames of the measures that are held to it; fold one frame after the other.
class SmallestErrors {
 public:
  void add(const FrameMeasurement& measured);
  /// Against the truth's own error of all, terrain and buildings.
  std::vector<TruthCheck> check(const BinErrors (&own)[3], bool has_buildings) const;

 private:
  struct Values {
    double power_error = 0;
    double median_db = 0;
    double gap_fraction = 0;
    double false_light_fraction = 0;
  };
  Values smallest_[3];
};

/// How far a truth is from a finer one.
std::vector<TruthCheck> check_truth(const TruthBins& truth, const TruthBins& finer, const RangeBins& ranges,
                                    const SmallestErrors& smallest);

struct TruthQuality {
  ReferenceSampling sampling;      ///< good enough, or the last that was allowed
  std::vector<TruthCheck> checks;  ///< of that sampling, on the probe's azimuths
  AzimuthRuns probe;
  bool holds = false;
};

/// Doubles the planes from `start`, and halves the steps where these alone are too long, until every check
/// holds on the probe or the planes would be more than `most_planes`. measure(truth) gives the errors of the
/// frames that will be shown, against that truth.
TruthQuality search_truth(const FramePlan& plan, const AzimuthRuns& probe, ReferenceSampling start,
                          int most_planes, const std::function<SmallestErrors(const TruthBins&)>& measure,
                          const Progress& progress);

}  // namespace obliq
