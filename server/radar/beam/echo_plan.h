#pragma once
// How the bins of a radar with a beam and a pulse follow from sharp ones: the settings of a sharp frame with
// a wider sector and swath, and the weights of two sums over its bins (README.md beside this file).
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/echo_layout.h"
#include "server/radar/bins.h"
#include "server/radar/settings.h"
#include "terrain/base/errors.h"

namespace obliq {

/// Weights of a beam by elevation: set k is that of ground at cosine_steps::cosine(k). The squares of a set
/// times the width of a sharp bin add up to 1: what an echo's power gains by its own elevation is in the
/// sharp bins already (AntennaGain), so that level ground keeps its power whichever set its rows take.
struct AzimuthKernels {
  int length = 1;  ///< of a set, with `pad` zeros on either side
  int pad = 0;
  std::vector<float> voltage;  ///< [sets][length]
  std::vector<float> power;    ///< their squares
  std::vector<int> unused;     ///< [sets] taps on either side that are 0
};

/// The plan of a blurred frame. Immutable once made.
struct EchoPlan {
  RadarSettings sharp;  ///< of the inner frame
  int n_azimuth = 0;    ///< output bins
  int n_range = 0;
  int azimuth_parts = 1;  ///< sharp bins an output bin, each way
  int range_parts = 1;
  /// Sharp azimuth bin at the left edge of output bin 0; the sharp frame's bearing is turned clockwise by
  /// this many of its bins to make it whole.
  int first_azimuth = 0;
  double turn_bins = 0;
  bool wraps = false;   ///< the sharp frame goes all the way round
  int first_range = 0;  ///< sharp range bin at the near edge of output bin 0
  SpeckleKind speckle = SpeckleKind::ground;
  bool range_normalisation = false;  ///< to be done with the bins
  double power_scale = 1;            ///< from sharp powers, of 1 W and 0 dBi, to the radar's

  /// A sharp row has the azimuth weights of what it sees in a tile of kTile sharp range bins
  /// (SharpWedge::kernels), as far as there may be ground so steep. The first is of sharp azimuth
  /// first_azimuth + first_tap.
  static constexpr int kTile = EchoLayout::kTile;
  int first_tap = 0;
  int n_taps = 1;
  AzimuthKernels kernels;
  std::vector<std::uint8_t> steepest;  ///< [tiles] the last set that a tile's rows may have
  /// Of the beam on the ground, for the sharp frame's AntennaGain; null without a beam.
  std::shared_ptr<const BeamWidths> widths;
  /// Of sharp range bins first_range + first_gate_tap + j from an output bin's first.
  int first_gate_tap = 0;
  std::vector<float> gate_voltage, gate_power;
  /// [sharp.range_bins] what eclipsing leaves of the sharp bins' voltages. Empty: all.
  std::vector<float> amplitude;
  /// Gate m's phase with speckle "none": -4 pi r / lambda.
  double wavelength_m = 0;

  bool draws() const { return speckle == SpeckleKind::none || speckle == SpeckleKind::independent; }
  /// Sharp azimuth of tap 0 of an output bin; counted on beyond the edges where the frame wraps.
  int first_row(int output) const { return first_azimuth + output * azimuth_parts + first_tap; }
  /// Rows of sharp azimuths that neighbouring output bins are made from.
  int rows_of(int n_outputs) const { return (n_outputs - 1) * azimuth_parts + n_taps; }
  /// The sharp frame's own azimuth.
  int sharp_azimuth(int row) const {
    const int all = sharp.azimuth_bins;
    return wraps ? ((row % all) + all) % all : row;
  }
};

/// Whether the bins of these settings are made from sharp ones.
inline bool needs_echo_plan(const RadarSettings& s) { return blurs(s) || draws_speckle(s); }

/// The range up to which a sharp wedge counts for some output bins, a few bins more for scatterers that lie
/// across an edge; without end where all of it may.
double needed_range_m(const EchoPlan& plan, int sharp_wedge, AzimuthRange outputs);

/// Of settings that need one. Nothing, with a reason, where the sector leaves no room.
std::optional<EchoPlan> plan_echo(const RadarSettings& settings, const EchoPlace& place,
                                  std::vector<FieldError>& errors);

}  // namespace obliq
