#include "server/radar/beam/echo_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <string>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/doppler_fault.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/echo_sums.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/doppler/doppler_plan.h"
#include "server/radar/sea_state.h"
#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kFarthest_m = 500e3;  // radar.r_max_m's limit
/// Each pixel's ray costs the same, however little of it a beam sees: the halo of the frusta that cast rays
/// holds a beam down to 60 degrees of depression; below that its skirts are cut off.
constexpr double kLeastCosineOfRays = 0.5;
/// More sharp bins than any server lets pass: what counts them stays within an int.
constexpr double kMostBins = 1 << 28;
/// A bin that does not meet its neighbour by so little of its width does meet it.
constexpr double kGap_bins = 1e-6;

int counted(double bins) { return static_cast<int>(std::min(bins, kMostBins)); }

int up_to_wedges(int bins) { return (bins + kWedgeAzimuthBins - 1) / kWedgeAzimuthBins * kWedgeAzimuthBins; }

/// What std::vector has for so many elements that came one by one, and malloc(3) adds to it.
std::int64_t grown_bytes(std::int64_t elements, std::int64_t each) {
  constexpr std::int64_t kOfMalloc = 32;
  return static_cast<std::int64_t>(std::bit_ceil(static_cast<std::uint64_t>(elements))) * each + kOfMalloc;
}

/// I&Q, a look of the video and power in floats, count and state (SharpWedge).
constexpr std::int64_t kSharpBytesABin = 20 + 5;
constexpr std::int64_t kSineBytesABin = 4;
/// BeamWidths: 400 steps come down to what a table of elevations can tell from straight below.
constexpr std::int64_t kWidthsBytes = 512 * sizeof(double) + 128;
/// An antenna so high sees all its ground steeply; one on the ground, none.
const EchoPlace kHigh{std::numeric_limits<double>::infinity(), 0, {}};
/// Of what flies in the air.
constexpr double kFast_m_s = 1000;
/// Any that leans, as any height does, sees all azimuths at any scan angle from there.
const AntennaAxes kLeaning(1, 0, 0);

}  // namespace

namespace {

double greatest_sine(const EchoPlace& place, double range_m) {
  if (!(place.height_m > 0)) return 0;
  return place.height_m < range_m ? place.height_m / range_m : 1;
}

/// About the antenna's own vertical.
double greatest_own_sine(const EchoPlace& place, double range_m) {
  const double sine = greatest_sine(place, range_m);
  if (place.axes.is_level()) return sine;
  const double own_rad = std::asin(sine) + place.axes.lean_rad();
  return own_rad < kPi / 2 ? std::sin(own_rad) : 1;
}

/// How far beside a scan angle the ground may lie that an antenna which is not stabilised sees there, over
/// the scan angles up to half_rad on either side of the sector's centre.
double greatest_turn_rad(const EchoPlace& place, double range_m, double half_rad) {
  constexpr int kAzimuths = 180;
  constexpr int kElevations = 16;
  const double sine = greatest_sine(place, range_m);
  // Straight above and below its own axis an antenna sees every azimuth.
  if (std::asin(sine) + place.axes.lean_rad() >= kPi / 2) return kPi;
  double greatest = 0;
  for (int a = -kAzimuths; a <= kAzimuths; ++a) {
    ask(2 * kElevations * 100);
    const double scan_rad = half_rad * a / kAzimuths;
    const SinCos scan = sincos_turns(scan_rad / (2 * kPi));
    for (int e = -kElevations; e <= kElevations; ++e) {
      const double seen_rad = place.axes.azimuth_seen_rad(scan, sine * e / kElevations);
      greatest = std::max(greatest, std::abs(std::remainder(seen_rad - scan_rad, 2 * kPi)));
    }
  }
  // Between the samples.
  return greatest * (1 + 1.0 / kElevations);
}

/// How far a beam reaches into a sharp frame's azimuths.
class Halo {
 public:
  Halo(const RadarSettings& s, const EchoLayout& layout, const AzimuthPattern& pattern)
      : layout_(layout),
        beam_(pattern, layout.turn_rad, layout.azimuth_rad),
        own_(s.azimuth_bins * layout.azimuth_parts),
        circle_(2 * kPi / layout.azimuth_rad),
        whole_circle_(s.sector_deg == 360) {}

  double circle() const { return circle_; }
  bool closes() const { return std::abs(circle_ - std::round(circle_)) <= kGap_bins; }
  int reach(double cosine) const {
    return counted(std::ceil(beam_.extent_rad(cosine) / layout_.azimuth_rad));
  }
  bool goes_round(int reach) const {
    return reach > 0 && (whole_circle_ || own_ + 2.0 * up_to_wedges(reach) >= circle_ * (1 - 1e-9));
  }
  /// In whole wedges, so that it does not go round.
  int longest_beside() const {
    const auto bins = static_cast<int>((circle_ - own_) / 2) / kWedgeAzimuthBins * kWedgeAzimuthBins;
    return goes_round(bins) ? bins - kWedgeAzimuthBins : bins;
  }

 private:
  const EchoLayout& layout_;
  BeamOnGround beam_;
  int own_;
  double circle_;
  bool whole_circle_;
};

}  // namespace

int steepest_step(const EchoPlace& place, double range_m) {
  return cosine_steps::nearest(greatest_own_sine(place, range_m));
}

double least_cosine(const EchoPlace& place, double range_m) {
  const double sine = greatest_own_sine(place, range_m);
  return std::sqrt(1 - sine * sine);
}

namespace {

GroundLayout lay_out_ground(const EchoLayout& layout, const Halo& beam, const EchoPlace& place) {
  GroundLayout ground;
  const int circle = counted(beam.closes() ? std::round(beam.circle()) : std::floor(beam.circle()));
  const double half_rad = std::min(kPi, layout.sharp_azimuths * layout.azimuth_rad / 2);
  const double turn_rad = greatest_turn_rad(place, layout.r_min_m, half_rad);
  // A bin on, into which the nearer part of a bin may fall.
  ground.reach = std::min(counted(std::ceil(turn_rad / layout.azimuth_rad)) + 2, (circle - 1) / 2);
  ground.azimuths = layout.sharp_azimuths + 2 * up_to_wedges(ground.reach);
  if (ground.azimuths < circle) return ground;
  ground.wraps = beam.closes();
  if (ground.wraps) {
    ground.azimuths = circle;
  } else {
    // Bins that do not meet behind the antenna leave out what it sees farther round.
    const int beside = (circle - layout.sharp_azimuths) / 2;
    ground.azimuths = layout.sharp_azimuths + 2 * beside;
    ground.reach = std::min(ground.reach, beside);
  }
  return ground;
}

}  // namespace

EchoLayout lay_out_echo(const RadarSettings& s, const AzimuthPattern& pattern, const EchoPlace& place) {
  EchoLayout layout;
  const double across_m_s = place.velocity.most_across_m_s(s.sector_deg * kPi / 180);
  layout.wanted_parts = azimuth_sub_bins(s, across_m_s);
  layout.azimuth_parts = std::min(layout.wanted_parts, kMostSubBins);
  layout.range_parts = std::min(range_sub_bins(s), kMostSubBins);

  const double range_bin_m = s.range_bin_m();
  layout.range_m = range_bin_m / layout.range_parts;
  const int extent = PointResponse(s).reach_bins(range_bin_m, s.pulse.extent_bins);
  const auto with_room = [&](double room_m) {
    return static_cast<int>(std::clamp<double>(room_m / range_bin_m, 0, extent)) * layout.range_parts;
  };
  layout.near = with_room(s.r_min_m - std::max(0.0, place.least_r_min_m));
  layout.far = with_room(kFarthest_m - s.r_max_m);
  layout.gate_reach = extent * layout.range_parts;
  layout.sharp_ranges = s.range_bins * layout.range_parts + layout.near + layout.far;
  layout.r_min_m = std::max(0.0, s.r_min_m - layout.near * layout.range_m);

  const int own = s.azimuth_bins * layout.azimuth_parts;
  layout.azimuth_rad = s.azimuth_bin_rad() / layout.azimuth_parts;
  if (s.scan_mode != ScanMode::frame) layout.turn_rad = layout.azimuth_rad * layout.azimuth_parts;
  const Halo beam(s, layout, pattern);
  if (s.mode == RadarMode::sar) {
    const double cell_rad = s.doppler.resolution_m / layout.r_min_m;
    const double reach_rad = DopplerResponse::kSarCells * cell_rad + place.sea.smear.reach_rad();
    layout.reach = counted(std::ceil(reach_rad / layout.azimuth_rad));
  }
  if (has_beam(s)) {
    const double cosine = least_cosine(place, layout.r_min_m);
    const int needed = beam.reach(std::max(kLeastCosineOfRays, cosine));
    layout.n_kernels = steepest_step(place, layout.r_min_m) + 1;
    layout.reach = s.frustum == FrustumKind::sweep
                       ? beam.reach(std::max(cosine, cosine_steps::cosine(cosine_steps::kCount - 1)))
                       : needed;
    // Bins that do not meet behind the antenna leave the beam's skirts on the steepest ground out.
    if (!beam.closes() && beam.goes_round(layout.reach) && !beam.goes_round(needed))
      layout.reach = beam.longest_beside();
  }
  const double circle = beam.circle();
  const int halo = up_to_wedges(layout.reach);
  layout.wraps = beam.goes_round(layout.reach);
  if (!layout.wraps) {
    layout.first_azimuth = halo;
    layout.sharp_azimuths = own + 2 * halo;
    if (!place.axes.is_level()) layout.ground = lay_out_ground(layout, beam, place);
    return layout;
  }
  layout.closes = beam.closes();
  layout.sharp_azimuths = counted(layout.closes ? std::round(circle) : std::ceil(circle));
  layout.reach = std::min(layout.reach, (layout.sharp_azimuths - layout.azimuth_parts) / 2);
  layout.first_azimuth = (layout.sharp_azimuths - own) / 2;
  if (!place.axes.is_level()) layout.ground = lay_out_ground(layout, beam, place);
  return layout;
}

RadarSettings sharp_frame(const RadarSettings& s, const EchoLayout& layout) {
  RadarSettings sharp = s;
  sharp.beam.pattern = BeamPattern::off;
  sharp.pulse.kind = PulseKind::off;
  sharp.speckle = draws_speckle(s) ? SpeckleKind::ground : resolved_speckle(s);
  sharp.power_w = 1;
  sharp.gain_db = 0;
  sharp.range_normalisation = false;
  sharp.receiver = {};

  sharp.range_bins = layout.sharp_ranges;
  sharp.r_min_m = layout.r_min_m;
  sharp.r_max_m = s.r_max_m + layout.far * layout.range_m;

  const int own = s.azimuth_bins * layout.azimuth_parts;
  sharp.azimuth_bins = layout.sharp_azimuths;
  if (layout.wraps) {
    sharp.sector_deg = 360;
  } else if (layout.sharp_azimuths > own) {
    sharp.sector_deg = s.sector_deg / own * layout.sharp_azimuths;
  }

  // As many planes or pixels a bin as the settings ask for.
  if (s.frustum == FrustumKind::sweep) {
    const int a_part = (sweep_columns_per_bin(s) + layout.azimuth_parts - 1) / layout.azimuth_parts;
    sharp.pixel_columns = counted(static_cast<double>(a_part) * sharp.azimuth_bins);
    return sharp;
  }
  const auto widened = [](int pixels, double ratio) {
    return counted(std::ceil(pixels * ratio * (1 - 1e-12)));
  };
  sharp.pixel_columns = widened(s.pixel_columns, sharp.azimuth_bins / static_cast<double>(own));
  sharp.pixel_rows =
      widened(s.pixel_rows, sharp.range_bins / (static_cast<double>(s.range_bins) * layout.range_parts));
  return sharp;
}

RadarSettings ground_frame(const RadarSettings& s, const EchoLayout& layout) {
  RadarSettings ground = sharp_frame(s, layout);
  if (layout.ground.azimuths == 0) return ground;
  const auto wider = [&](int sharp) {
    return counted(
        std::ceil(static_cast<double>(sharp) / ground.azimuth_bins * layout.ground.azimuths * (1 - 1e-12)));
  };
  ground.pixel_columns = wider(ground.pixel_columns);
  ground.azimuth_bins = layout.ground.azimuths;
  ground.sector_deg = std::min(360.0, layout.azimuth_rad * 180 / kPi * layout.ground.azimuths);
  if (layout.ground.wraps) ground.sector_deg = 360;
  return ground;
}

EchoSize echo_size(const RadarSettings& s, std::int64_t threads, int label_materials) {
  const bool rolls = !s.beam.stabilised;
  EchoPlace place{kHigh.height_m, kHigh.least_r_min_m, rolls ? kLeaning : AntennaAxes()};
  place.velocity.right_m_s = kFast_m_s;
  const bool smears_sea = s.mode == RadarMode::sar && sea_state(s) > 0;
  if (smears_sea) place.sea.smear = kMostSeaSmear;
  const EchoLayout layout = lay_out_echo(s, AzimuthPattern(s), place);
  EchoSize size;
  size.sharp = ground_frame(s, layout);
  if (uses_doppler(s)) {
    // Of a slower antenna, whose sharp bins are wider: each with one plane more at most, and four halos of
    // whole wedges.
    const double outputs = std::ceil(static_cast<double>(size.sharp.azimuth_bins) / layout.azimuth_parts) +
                           6 * kWedgeAzimuthBins;
    const double columns = s.frustum == FrustumKind::sweep
                               ? sweep_columns_per_bin(s) + layout.azimuth_parts - 1.0
                               : static_cast<double>(s.pixel_columns) / s.azimuth_bins;
    size.sharp.pixel_columns = std::max(size.sharp.pixel_columns, counted(std::ceil(columns * outputs)));
  }
  size.n_taps = layout.n_taps();
  size.n_kernels = layout.n_kernels;
  size.n_tiles = layout.n_tiles();

  // Of each elevation weights and their squares with zeros on either side; widths on the ground.
  constexpr std::int64_t kFloat = sizeof(float);
  const std::int64_t n_gates = layout.n_gates();
  constexpr std::int64_t kPage = 4096;  // of large arrays, which malloc(3) maps
  size.plan_bytes = 2 * (size.n_kernels * std::int64_t{layout.kernel_length()} * kFloat + kPage) +
                    grown_bytes(size.n_kernels, sizeof(int)) + grown_bytes(size.n_tiles, 1) +
                    2 * grown_bytes(n_gates, kFloat) + grown_bytes(layout.sharp_ranges, kFloat) +
                    kWidthsBytes;

  // Rows of I&Q and of power in three floats a bin; where the rows' weights stand.
  constexpr auto spare = static_cast<std::int64_t>(EchoSums::kSpare);
  const std::int64_t row = layout.stride() + 2 * (n_gates + spare);
  size.sums_bytes = 3 * kFloat * (kWedgeAzimuthBins * row + layout.stride() + spare) +
                    2 * kFloat * layout.stride() + 2 * grown_bytes(s.range_bins, 2 * kFloat) + size.n_tiles +
                    13 * (size.n_taps + kWedgeAzimuthBins * layout.azimuth_parts) + 4 * grown_bytes(0, 0);

  if (has_doppler_filter(s)) {
    // DopplerRows: Doppler, I&Q and powers of the current rows; of the sea (SeaPart) as many again.
    // DopplerPlan, polynomials of a canceller.
    const std::int64_t kRowFloats = sea_state(s) > 0 ? 20 : 8;
    const std::int64_t kinds = sea_state(s) > 0 ? 3 : 1;
    // Of responses (SpreadResponse).
    const SharpRanges ranges{layout.r_min_m, layout.range_m, static_cast<int>(layout.stride())};
    const std::int64_t n_tables = smears_sea ? 1 + 2 * std::int64_t{most_sea_responses(ranges)} : kinds;
    constexpr std::int64_t kSpanBytes = sizeof(CellSpan);
    const int sar_cells = counted(
        std::ceil(DopplerResponse::kSarCells +
                  place.sea.smear.spread_rad * ranges.middle_m(ranges.n - 1) / s.doppler.resolution_m));
    const std::int64_t cells = std::max(sar_cells, s.doppler.pulses);
    size.sums_bytes += (size.n_taps + kWedgeAzimuthBins * (layout.azimuth_parts + 2)) *
                       (kRowFloats * kFloat * layout.stride() + 650 + kinds * kSpanBytes * size.n_tiles);
    size.plan_bytes += 4 * size.n_kernels * std::int64_t{layout.kernel_length()} * kFloat + kPage +
                       grown_bytes(layout.stride(), sizeof(double)) +
                       2 * grown_bytes(layout.stride(), kFloat) + grown_bytes(size.n_tiles, kSpanBytes) +
                       grown_bytes(size.n_tiles, sizeof(std::size_t)) +
                       n_tables * (grown_bytes(DopplerResponse::n_steps(cells), kFloat) +
                                   grown_bytes(DopplerResponse::n_terms(cells), kFloat));
  }

  if (s.mode == RadarMode::pulses) {
    // GroundPulses: a train's pulses in two floats, and some rows with what moves of them in the wind.
    constexpr std::int64_t kRowBytes = sizeof(double) + 2 * kFloat;
    size.plan_bytes +=
        2 * kFloat * row * s.doppler.pulses + 2 * std::int64_t{kPulseRows} * kRowBytes * layout.stride();
  }

  // An output wedge's, those of the next ones in progress, and lists of both.
  constexpr std::int64_t kWedge = kWedgeAzimuthBins;
  const std::int64_t rows = std::min(size.n_taps + kWedge * (layout.azimuth_parts + 2 * threads),
                                     std::int64_t{layout.sharp_azimuths});
  const std::int64_t list =
      grown_bytes(rows / kWedge + 2, sizeof(int)) + std::int64_t{2 * sizeof(std::vector<int>)};
  const std::int64_t of_labels = label_materials == 0 ? 0 : LabelShare::bytes_a_bin(label_materials) + 1;
  const std::int64_t of_doppler = uses_doppler(s) ? kSineBytesABin : 0;
  const std::int64_t row_bytes = layout.stride() * (kSharpBytesABin + of_labels + of_doppler) + size.n_tiles;
  size.rows_bytes = rows * row_bytes + wedge_count(s.azimuth_bins) * list;
  size.sharp_bytes = layout.sharp_azimuths * row_bytes;
  if (rolls) {
    // All azimuths of the ground, with where they are seen, for all scan angles.
    size.sharp_bytes = layout.ground.azimuths * (row_bytes + 2 * kFloat * layout.stride());
    size.rows_bytes +=
        size.sharp_bytes + wedge_count(layout.sharp_azimuths) *
                               (list + grown_bytes(layout.ground.azimuths / kWedge + 2, sizeof(int)));
  }
  return size;
}

std::optional<FieldError> layout_fault(const RadarSettings& s, const EchoLayout& layout,
                                       const EchoPlace& place) {
  if (auto fault = image_fault(s, place)) return fault;
  if (!layout.closes)
    return FieldError{
        "bins.azimuth",
        std::to_string(s.azimuth_bins) + " in a sector that the beam widens to the full circle",
        "a number that divides the circle, so that the bins meet; or a narrower beam or sector"};
  if (s.frustum == FrustumKind::sweep) return std::nullopt;
  // Pixels have numbers of 32 bits (RayBatch).
  constexpr std::int64_t kMostPixels = std::numeric_limits<std::uint32_t>::max();
  const RadarSettings sharp = sharp_frame(s, layout);
  if (std::int64_t{sharp.pixel_columns} * sharp.pixel_rows > kMostPixels)
    return FieldError{"frustum.pixel_columns",
                      std::to_string(sharp.pixel_columns) + " x " + std::to_string(sharp.pixel_rows) +
                          " pixels with what beam and pulse reach",
                      "at most " + std::to_string(kMostPixels) + " in all; or the sweep, which has none"};
  return std::nullopt;
}

std::optional<std::vector<FieldError>> layout_faults(const RadarSettings& s, const AntennaAxes& axes) {
  if (uses_doppler(s)) return std::nullopt;
  const AzimuthPattern pattern(s);
  const auto fault_at = [&](const EchoPlace& place) {
    return layout_fault(s, lay_out_echo(s, pattern, place), place);
  };
  // The higher the antenna, the larger the sharp frame.
  if (!fault_at({kHigh.height_m, kHigh.least_r_min_m, axes})) return std::vector<FieldError>{};
  // On the ground, without bins nearer than its own.
  if (const auto fault = fault_at({0, s.r_min_m, axes})) return std::vector<FieldError>{*fault};
  return std::nullopt;
}

}  // namespace obliq
