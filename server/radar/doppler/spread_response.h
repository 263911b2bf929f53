#pragma once
#include "server/radar/doppler/doppler_response.h"

namespace obliq {

/// What the filter of a map or an image makes of echoes whose Doppler is not one frequency but a Gaussian
/// about it, as the sea's is.
///
/// Power: the mean of D^2 over the Gaussian. With the weights' autocorrelation a[l] it is sum over l of
/// a[l] exp(-2 (pi s l / N)^2) cos(2 pi l u / N), s the deviation in cells.
/// Voltages: an echo keeps its own, times the root of that power, at a phase of pi c u^2. So neighbouring
/// outputs are no more alike than those of the filter are, however wide the Gaussian: c makes their
/// correlation as wide as that of a train under these weights (the second moments of both in time agree, over
/// what the beam shows where it has most cells). Their grain is up to twice as wide where the beam has fewer
/// cells than the Gaussian is wide, and without a window, whose sidelobes count.
class SpreadResponse {
 public:
  /// beam_cells: of its half power width, the most in the sector (cells_in_beam).
  SpreadResponse(const DopplerSettings& settings, double deviation_cells, double beam_cells);
  /// Of a synthetic aperture, which has all of the beam: as far as end_cells, with all of the power.
  static SpreadResponse of_aperture(const DopplerSettings& settings, double deviation_cells, int end_cells);

  /// The weight's parts in phase and a quarter turn ahead; their squares add up to the power.
  const DopplerResponse& in_phase() const { return in_phase_; }
  const DopplerResponse& ahead() const { return ahead_; }

 private:
  struct Parts {
    std::vector<double> in_phase, ahead;
    void add(double root, double phase);
  };
  static Parts train_parts(const DopplerSettings& settings, double deviation_cells, double beam_cells);
  SpreadResponse(const Parts& parts, int period_cells)
      : in_phase_(parts.in_phase, period_cells), ahead_(parts.ahead, period_cells) {}

  DopplerResponse in_phase_, ahead_;
};

}  // namespace obliq
