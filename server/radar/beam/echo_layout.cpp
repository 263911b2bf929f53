#include "server/radar/beam/echo_layout.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/echo_plan.h"
#include "server/radar/beam/echo_sums.h"
#include "server/radar/beam/point_response.h"
#include "server/radar/beam/sub_bins.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
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
/// BeamWidths: 400 steps come down to what a table of elevations can tell from straight below.
constexpr std::int64_t kWidthsBytes = 512 * sizeof(double) + 128;
/// An antenna so high sees all its ground steeply; one on the ground, none.
constexpr EchoPlace kHigh{std::numeric_limits<double>::infinity(), 0};

}  // namespace

namespace {

double greatest_sine(const EchoPlace& place, double range_m) {
  if (!(place.height_m > 0)) return 0;
  return place.height_m < range_m ? place.height_m / range_m : 1;
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
  return cosine_steps::nearest(greatest_sine(place, range_m));
}

double least_cosine(const EchoPlace& place, double range_m) {
  const double sine = greatest_sine(place, range_m);
  return std::sqrt(1 - sine * sine);
}

EchoLayout lay_out_echo(const RadarSettings& s, const AzimuthPattern& pattern, const EchoPlace& place) {
  EchoLayout layout;
  layout.azimuth_parts = std::min(azimuth_sub_bins(s), kMostSubBins);
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
  if (s.beam.pattern != BeamPattern::off) {
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
    return layout;
  }
  layout.closes = beam.closes();
  layout.sharp_azimuths = counted(layout.closes ? std::round(circle) : std::ceil(circle));
  layout.reach = std::min(layout.reach, (layout.sharp_azimuths - layout.azimuth_parts) / 2);
  layout.first_azimuth = (layout.sharp_azimuths - own) / 2;
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

EchoSize echo_size(const RadarSettings& s, std::int64_t threads, int label_materials) {
  const EchoLayout layout = lay_out_echo(s, AzimuthPattern(s), kHigh);
  EchoSize size;
  size.sharp = sharp_frame(s, layout);
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

  // An output wedge's, those of the next ones that are in hand, and lists of both.
  constexpr std::int64_t kWedge = kWedgeAzimuthBins;
  const std::int64_t rows = std::min(size.n_taps + kWedge * (layout.azimuth_parts + 2 * threads),
                                     std::int64_t{layout.sharp_azimuths});
  const std::int64_t list =
      grown_bytes(rows / kWedge + 2, sizeof(int)) + std::int64_t{2 * sizeof(std::vector<int>)};
  const std::int64_t of_labels = label_materials == 0 ? 0 : LabelShare::bytes_a_bin(label_materials) + 1;
  const std::int64_t row_bytes = layout.stride() * (kSharpBytesABin + of_labels) + size.n_tiles;
  size.rows_bytes = rows * row_bytes + wedge_count(s.azimuth_bins) * list;
  size.sharp_bytes = layout.sharp_azimuths * row_bytes;
  return size;
}

std::optional<FieldError> layout_fault(const RadarSettings& s, const EchoLayout& layout) {
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

std::optional<std::vector<FieldError>> layout_faults(const RadarSettings& s) {
  const AzimuthPattern pattern(s);
  // The higher the antenna, the larger the sharp frame.
  if (!layout_fault(s, lay_out_echo(s, pattern, kHigh))) return std::vector<FieldError>{};
  // On the ground, without bins nearer than its own.
  if (const auto fault = layout_fault(s, lay_out_echo(s, pattern, {0, s.r_min_m})))
    return std::vector<FieldError>{*fault};
  return std::nullopt;
}

}  // namespace obliq
