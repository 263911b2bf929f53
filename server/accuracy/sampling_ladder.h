#pragma once
// The coarsest sampling of a kind that is accurate enough, found by trying.
#include <functional>
#include <optional>
#include <vector>

#include "server/accuracy/measure_frame.h"
#include "server/accuracy/sampling_case.h"

namespace obliq {

/// What a user allows: see [accuracy] in a scene file.
struct AccuracyLimit {
  double median_db = 0;
  double gap_fraction = 0;

  /// Never where nothing was compared.
  bool met_by(const BinErrors& e) const {
    return e.compared() > 0 && e.median_db <= median_db && e.gap_fraction() <= gap_fraction;
  }
};

struct TriedSampling {
  SamplingCase sampling;
  BinErrors errors;  ///< of all returns
};

/// Samplings of the settings' own kind and plates, each about four (the sweep: two) times the work of the one
/// before, up to the limit of 16384 pixels. Polar and sweep follow the bins.
std::vector<SamplingCase> sampling_ladder(const RadarSettings& settings, double cell_m);

/// Climbs the ladder until the errors meet the limit. `measure` throws InputError where a sampling cannot see
/// the scene; that is passed on. The last of the list meets the limit, or nothing does.
std::vector<TriedSampling> climb(const std::vector<SamplingCase>& ladder, const AccuracyLimit& limit,
                                 const std::function<BinErrors(const SamplingCase&)>& measure);

}  // namespace obliq
