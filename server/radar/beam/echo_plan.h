#pragma once
// How the bins of a radar with a beam and a pulse follow from sharp ones: the settings of a sharp frame with
// a wider sector and swath, and the weights of two sums over its bins (README.md beside this file).
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/echo_layout.h"
#include "server/radar/bins.h"
#include "server/radar/doppler/doppler_plan.h"
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
  /// [sets][length][4] of a canceller whose antenna turns: even and odd terms (CancellerTerms). Else empty.
  std::vector<float> cancelled;
};

/// Which rows neighbouring azimuths are made from: each of n_taps rows, azimuth_parts on from the one before.
struct RowWindow {
  int n_azimuth = 0;      ///< that are made
  int n_rows = 0;         ///< that there are
  int azimuth_parts = 1;  ///< rows from an azimuth to the next
  int first_azimuth = 0;  ///< row at the left edge of azimuth 0
  int first_tap = 0;      ///< from there
  int n_taps = 1;
  bool wraps = false;  ///< the rows go all the way round

  /// Row of tap 0 of an azimuth; counted on beyond the edges where the rows wrap.
  int first_row(int azimuth) const { return first_azimuth + azimuth * azimuth_parts + first_tap; }
  int rows_of(int n_azimuths) const { return (n_azimuths - 1) * azimuth_parts + n_taps; }
  /// The rows' own number.
  int sharp_azimuth(int row) const { return wraps ? ((row % n_rows) + n_rows) % n_rows : row; }
};

/// The ground that an antenna which is not stabilised looks at: the sharp bins of its scan angles are made
/// from sharp bins of the ground's own azimuths (TurnedRows).
struct GroundAzimuths {
  AntennaAxes axes;
  RadarSettings frame;  ///< of what is looked at
  RowWindow rows;       ///< of it, that scan angles may see
  double azimuth_rad = 0;
  double scan_start_rad = 0;  ///< left edge of the first sharp bin of scan angles, from the sector's centre
  double start_rad = 0;       ///< the same of the ground's
  double above_ground_m = 0;  ///< of the antenna
};

/// The plan of a blurred frame. Immutable once made.
struct EchoPlan : RowWindow {
  RadarSettings sharp;                   ///< of the inner frame, whose azimuths are the rows
  std::optional<GroundAzimuths> ground;  ///< of an antenna that rolls or pitches
  int n_range = 0;
  int range_parts = 1;  ///< sharp bins an output bin
  /// The sharp frame's bearing is turned clockwise by this many of its bins to make first_azimuth whole.
  double turn_bins = 0;
  int first_range = 0;  ///< sharp range bin at the near edge of output bin 0
  SpeckleKind speckle = SpeckleKind::ground;
  bool range_normalisation = false;  ///< to be done with the bins
  double power_scale = 1;            ///< from sharp powers, of 1 W and 0 dBi, to the radar's

  /// A sharp row has the azimuth weights of what it sees in a tile of kTile sharp range bins
  /// (SharpWedge::kernels), as far as there may be ground so steep.
  static constexpr int kTile = EchoLayout::kTile;
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

  /// Of modes other than map.
  std::shared_ptr<const DopplerPlan> doppler;
  /// The same where its filter stands before the bins; else null.
  const DopplerPlan* filter() const { return doppler && doppler->is_filter() ? doppler.get() : nullptr; }
  std::string doppler_warning;  ///< of too few rows for it
  double output_rad = 0;        ///< of an output azimuth
  double start_rad = 0;         ///< left edge of the first output, from the sector's centre
  /// Middles of outputs and of rows, from the sector's centre.
  double output_middle_rad(int azimuth) const { return start_rad + (azimuth + 0.5) * output_rad; }
  double row_middle_rad(int row) const { return start_rad + (row - first_azimuth + 0.5) * row_rad(); }
  double row_rad() const { return output_rad / azimuth_parts; }

  bool draws() const { return speckle == SpeckleKind::none || speckle == SpeckleKind::independent; }
  /// Settings of what is looked at.
  const RadarSettings& looks_at() const { return ground ? ground->frame : sharp; }
};

/// Whether the bins of these settings are made from sharp ones.
inline bool needs_echo_plan(const RadarSettings& s) {
  return blurs(s) || draws_speckle(s) || uses_doppler(s);
}

/// The range up to which a sharp wedge counts for some output bins, a few bins more for scatterers that lie
/// across an edge; without end where all of it may.
double needed_range_m(const EchoPlan& plan, int sharp_wedge, AzimuthRange outputs);

/// Of settings that need one. Nothing, with a reason, where the sector leaves no room.
std::optional<EchoPlan> plan_echo(const RadarSettings& settings, const EchoPlace& place,
                                  std::vector<FieldError>& errors);

}  // namespace obliq
