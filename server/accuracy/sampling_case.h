#pragma once
// The samplings that a frontier compares.
#include <functional>
#include <string>
#include <vector>

#include "server/accuracy/measure_frame.h"
#include "server/radar/settings.h"

namespace obliq {

/// Of pixel columns and rows (frustum.pixels).
constexpr int kMostSide = 16384;

/// One way to sample a frame, over ground of one cell size.
struct SamplingCase {
  FrustumKind kind = FrustumKind::oblique;
  PlateKind plates = PlateKind::spread;  ///< means nothing to the sweep
  int columns = 2048;                    ///< of pixels; the sweep's azimuths in the sector
  int rows = 2048;                       ///< 0 for the sweep
  double cell_m = 0;
  int sub_columns = 0;  ///< the sweep's; 0: exact strands

  bool operator==(const SamplingCase&) const = default;
};

/// The paper's setting: oblique, 2048 x 2048 pixels, each return in the bin of its centre.
SamplingCase paper_sampling(double cell_m);
inline bool is_paper_sampling(const SamplingCase& c) { return c == paper_sampling(c.cell_m); }

/// The paper's speckle, which the sweep has not, becomes the ground's there: powers are the same.
RadarSettings with_sampling(RadarSettings settings, const SamplingCase& sampling);

/// Settings for the truth's plan: a sweep's, which looks from any pose as the truth does. Flat plates have no
/// truth, and it says so itself: their scenes keep their own.
RadarSettings settings_for_truth(const RadarSettings& settings, const std::vector<Material>& materials);

/// "oblique 2048 x 2048 nearest", "sweep 2048, 64 sub-columns", "sweep 2048, exact".
std::string sampling_text(const SamplingCase& sampling);

/// What a frontier goes over.
struct FrontierRange {
  std::vector<int> pixels{1024, 2048, 4096};  ///< on each side of the symmetric and the oblique frustum
  std::vector<double> sweeps{1, 2, 4, 8};     ///< the sweep's azimuths per azimuth bin
  /// With each of the sweeps' azimuths, exact strands for 0. The first stands for all where nothing is built.
  std::vector<int> sub_columns{64, 16, 0};
  std::vector<double> cells_m;     ///< the first is the scene's: all samplings; others: a few
  std::vector<FrustumKind> kinds;  ///< those alone; empty: all
};

/// Every case once, grouped by cell in the order of cells_m, cheap ones first within a kind. The paper's
/// setting over the scene's cell is always among them where its kind is.
std::vector<SamplingCase> frontier_cases(const RadarSettings& settings, const FrontierRange& range);

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
/// before, up to the limit of 16384 pixels. The sweep's follow the bins.
std::vector<SamplingCase> sampling_ladder(const RadarSettings& settings, double cell_m);

/// Climbs the ladder until the errors meet the limit. `measure` throws InputError where a sampling cannot see
/// the scene; that is passed on. The last of the list meets the limit, or nothing does.
std::vector<TriedSampling> climb(const std::vector<SamplingCase>& ladder, const AccuracyLimit& limit,
                                 const std::function<BinErrors(const SamplingCase&)>& measure);

}  // namespace obliq
