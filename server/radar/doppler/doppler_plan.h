#pragma once
// What the sums over sharp bins need to know of Doppler: where each row and each output stands, and what the
// filter makes of it.
#include <complex>
#include <vector>

#include "server/radar/doppler/doppler_response.h"
#include "server/radar/doppler/ground_doppler.h"
#include "server/radar/doppler/sea_motion.h"
#include "server/radar/doppler/spread_response.h"
#include "server/radar/doppler/wind.h"
#include "server/radar/settings.h"
#include "server/radar/simd/receiver/row_doppler.h"

namespace obliq {

/// Range bins of a plan.
struct SharpRanges {
  double r_min_m = 0;
  double spacing_m = 0;
  int n = 0;  ///< a multiple of CellSpan::kBins
  double middle_m(int bin) const { return r_min_m + (bin + 0.5) * spacing_m; }
};

/// How many responses to the sea an image of synthetic aperture has at most.
int most_sea_responses(const SharpRanges& ranges);

/// Of a frame in a mode other than map. Immutable.
class DopplerPlan {
 public:
  /// turn_rad: how far the antenna turns between two pulses. above_ground_m: of the antenna over level
  /// ground, where a map's output looks for its echo.
  /// windy: materials whose echoes move in the wind; all_windy: there are no others.
  DopplerPlan(const RadarSettings& settings, const SectorVelocity& velocity, const SharpRanges& ranges,
              double turn_rad, double above_ground_m, std::vector<int> windy, MovingSea sea = {},
              bool all_windy = false);

  RadarMode mode() const { return mode_; }
  /// Something is made of the pulses: weight() has a meaning.
  bool is_filter() const { return mode_ != RadarMode::pulses; }
  bool is_canceller() const { return mode_ == RadarMode::mti; }
  int delays() const { return delays_; }
  bool has_lock() const { return has_lock_; }
  double turn_rad() const { return turn_rad_; }
  /// Rows are filtered by themselves, whatever output they count for: an antenna that does not turn while it
  /// cancels, and a notch that stays.
  bool is_of_rows() const { return is_canceller() && !has_lock_ && turn_rad_ == 0; }
  /// Ground that stands still under an antenna that only turns: a canceller is a matter of the beam alone.
  bool is_of_beam() const { return is_canceller() && turn_rad_ != 0 && velocity_.is_zero() && !has_moving(); }
  /// All rows have the same weights, from each output's own on.
  bool shares_weights() const { return is_of_rows() || is_of_beam(); }
  /// Of what a canceller gains of noise.
  double over_noise_root() const { return over_noise_root_; }
  /// Materials of which a share moves in the wind, and what the canceller leaves of that (moving_residue).
  const std::vector<int>& windy() const { return windy_; }
  bool all_windy() const { return all_windy_; }
  double moving_share() const { return moving_share_; }
  const ByLag& residue() const { return residue_; }
  /// The sea, its Doppler, and what the canceller leaves of it (sea_residue).
  bool has_sea() const { return !sea_.materials.empty(); }
  const MovingSea& sea() const { return sea_; }
  const GroundDoppler& sea_doppler() const { return sea_doppler_; }
  const ByLag& sea_residue() const { return sea_residue_; }
  /// And what a map or an image makes of it, by CellSpan::kBins (dbs, sar, has_sea()).
  const SpreadResponse& sea_response(std::size_t span) const {
    return sea_responses_[sea_response_of_[span]];
  }
  bool has_moving() const { return !windy_.empty() || has_sea(); }
  /// What is looked at is told apart by its material.
  bool needs_materials() const { return has_sea() || (!windy_.empty() && !all_windy_); }

  const SectorVelocity& velocity() const { return velocity_; }
  const GroundDoppler& ground() const { return ground_; }
  const DopplerResponse& response() const { return response_; }
  /// Turns of the phase for 1 Hz, at a range: between two pulses (mti), in a second (pulses); Doppler cells
  /// for 1 Hz (dbs, sar).
  double turns_a_hz(double range_m) const;
  /// The same [ranges], and sines of elevation of level ground.
  const std::vector<double>& turns_a_hz() const { return turns_a_hz_; }
  const std::vector<float>& level_sine() const { return level_sine_; }
  /// Of level ground, of modes that are not a canceller's: cells for 1 Hz on the level [ranges], and by
  /// CellSpan::kBins of them where they lie.
  const std::vector<float>& level_cells_a_hz() const { return level_cells_a_hz_; }
  const std::vector<CellSpan>& level_spans() const { return level_spans_; }
  double level_sine(double range_m) const;

  /// What an echo at f Hz and this range weighs in the output whose own is at an azimuth, its two-way voltage
  /// gains, i pulses before, in gains: all c + 1 of them, or one.
  std::complex<double> weight(double hz, double range_m, const SinCos& output,
                              const std::vector<double>& gains) const;

 private:
  void place_level_ground();
  void spread_sea(const RadarSettings& settings, const SharpRanges& ranges);

  RadarMode mode_;
  int delays_;
  double over_noise_root_;
  bool has_lock_;
  double turn_rad_;
  double above_ground_m_;
  double pulse_s_;
  double train_s_;
  double sar_s_a_m_ = 0;  ///< time over range of a synthetic aperture
  SectorVelocity velocity_;
  std::vector<int> windy_;
  bool all_windy_;
  double moving_share_ = 0;
  ByLag residue_{};
  MovingSea sea_;
  GroundDoppler sea_doppler_;
  ByLag sea_residue_{};
  std::vector<SpreadResponse> sea_responses_;
  std::vector<std::size_t> sea_response_of_;
  GroundDoppler ground_;
  DopplerResponse response_;
  std::vector<double> turns_a_hz_;
  std::vector<float> level_sine_;
  std::vector<float> level_cells_a_hz_;
  std::vector<CellSpan> level_spans_;
};

}  // namespace obliq
