#pragma once
// The truth of a frame, on all of its azimuth bins or on wedges chosen evenly from them.
#include <cstdint>
#include <filesystem>
#include <vector>

#include "server/accuracy/bin_errors.h"
#include "server/radar/frame_plan.h"
#include "server/radar/render.h"
#include "server/truth/reference.h"

namespace obliq {

/// Which part of the returns is compared.
enum class Returns { all, terrain, buildings };

/// Runs of azimuth bins, rising, apart from each other.
using AzimuthRuns = std::vector<AzimuthRange>;

/// Whole wedges evenly spread over the sector that hold at least `wanted` azimuth bins; all for 0.
AzimuthRuns choose_azimuths(int azimuth_bins, int wanted);
int azimuth_count(const AzimuthRuns& runs);

struct TruthBins {
  AzimuthRuns runs;
  int n_range = 0;
  std::vector<double> ground_w;  ///< [azimuth_count(runs)][n_range]
  std::vector<double> building_w;
  std::vector<BuildingTruth> buildings;

  std::vector<double> power_w(Returns returns) const;
  /// Whether any bin has power at all.
  bool lit() const;
  /// Lays the truth of one run behind what is there; runs come in order.
  void append(const ReferenceBins& bins);
};

/// The frame as the reference renderer takes it, with its pattern in elevation, but without beam and pulse.
ReferenceView reference_view(const FramePlan& plan);

RangeBins range_bins(const RadarSettings& settings);

/// Integrates the truth of every run.
TruthBins integrate_truth(const FramePlan& plan, const AzimuthRuns& runs, const ReferenceSampling& sampling,
                          const Progress& progress = {});

/// Those azimuths of a block, in the truth's order: [azimuth_count(runs)][n_range].
std::vector<double> power_of_runs(const BinBlock& block, const AzimuthRuns& runs);

// Truth that outlives an interrupted run: each stretch of azimuths is appended to a file as it is done.

/// Integrates the truth of every run, in stretches of one wedge; what the file holds already is taken from
/// there. `key` names everything that the truth depends on: a file of another key is replaced. A stretch that
/// was cut off or damaged, and all behind it, is integrated again. Throws InputError when it cannot be
/// written.
TruthBins integrate_truth_in_file(const std::filesystem::path& path, std::uint64_t key, const FramePlan& plan,
                                  const AzimuthRuns& runs, const ReferenceSampling& sampling,
                                  const Progress& progress = {});

}  // namespace obliq
