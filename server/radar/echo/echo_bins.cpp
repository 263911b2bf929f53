#include "server/radar/echo/echo_bins.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "server/radar/echo/sea_echo.h"
#include "server/radar/simd/echoes/cross_section.h"
#include "server/radar/simd/kernels.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/asking.h"

namespace obliq {

namespace {
constexpr std::int64_t kASample = 20;  // in units of ask()

/// Ground cells in an azimuth bin: their side is more than a quarter of the shorter side of a bin at half the
/// range (SpeckleField).
double cells_in_azimuth_bin(const RadarSettings& s) {
  constexpr int kRings = 64;
  const double width_rad = s.azimuth_bin_rad();
  const double spacing_m = s.range_bin_m();
  double cells = 0;
  for (int ring = 0; ring < kRings; ++ring) {
    const double range_m = s.r_min_m + (s.r_max_m - s.r_min_m) * (ring + 0.5) / kRings;
    const double side_m = std::max(std::min(spacing_m, width_rad * range_m / 2) / 4, 1e-3);
    cells += width_rad * range_m * (s.r_max_m - s.r_min_m) / kRings / (side_m * side_m);
  }
  return cells;
}
}  // namespace

EchoBins::EchoBins(const ScenePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
                   AzimuthRange range, Surfaces surfaces, LabelParts labels)
    : plan_(plan),
      scattering_(scattering),
      speckle_(speckle),
      range_(range),
      surfaces_(surfaces),
      has_raster_gamma_(!plan.scene().world().raster_gamma.empty()),
      range_constant_(radar_equation_constant(plan.settings().power_w, plan.wavelength_m())),
      bins_(plan, speckle, true, labels) {
  cells_.axis = plan.bins();
  speckle.describe_cells(cells_);
  factors_.range_normalisation = normalises_samples(plan.settings());
  for (std::size_t material = 0; material < std::size(factors_.gamma); ++material)
    factors_.gamma[material] = material < scattering.size() ? scattering.constant_gamma(material) : 0;
  if (labels == LabelParts::all)
    datum_ = {plan.scene().world().frame, {plan.sector().antenna_m}, plan.sector().r_max_m};
  if (scattering.texture() != nullptr) pieces_ = std::make_unique<SeaPieces>();
  if (scattering.corners() != nullptr && surfaces != Surfaces::ground)
    foot_corner_.emplace(plan, *scattering.corners());
  restart(range);
}

void EchoBins::restart(AzimuthRange range) {
  range_ = range;
  bins_.restart(range.first);
  if (plan_.settings().speckle == SpeckleKind::geometric) return;
  scatterers_.resize(static_cast<std::size_t>(range.count), ScattererSums(scratch_));
  for (ScattererSums& sums : scatterers_) sums.restart(plan_.bins().n_range);
}

std::uint64_t EchoBins::add(const SampleBatch& samples) {
  const AntennaGain& antenna = plan_.antenna_gain();
  const glm::dvec3& at_m = plan_.sector().antenna_m;
  const bool geometric = plan_.settings().speckle == SpeckleKind::geometric;
  std::uint64_t binned = 0;
  std::uint32_t marked = kNoFace;
  ask(kASample * samples.n);
  active_kernels().bin_samples(cells_, factors_, samples, placed_);
  if (pieces_) texture_samples(samples);
  for (int s = 0; s < samples.n; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const double r = samples.slant_range_m[k];
    const int range_bin = placed_.range_bin[k];
    if (range_bin == BinnedSamples::kOutside || r < kNearest_m) continue;
    if (surfaces_ != Surfaces::all && (samples.face[k] == kNoFace) != (surfaces_ == Surfaces::ground))
      continue;
    double sigma = placed_.sigma_m2[k];
    if (std::isnan(sigma))
      sigma = scattering_.cross_section_m2(
          samples.material[k], samples.solid_angle_sr[k] * placed_.range2_m2[k], samples.cos_incidence[k]);
    const double dx = samples.x_m[k] - at_m.x;
    const double dz = samples.z_m[k] - at_m.z;
    double sine = samples.sin_elevation[k];
    if (scattering_.sea() != nullptr && samples.face[k] == kNoFace) {
      if (pieces_ && scattering_.sea()->over_gamma[samples.material[k]] > 0)
        sigma *= static_cast<double>(pieces_->tau[k]);
      sigma *= sea_over_gamma(*scattering_.sea(), samples.material[k], dx, dz, r, sine);
    }
    if (has_raster_gamma_ && samples.face[k] == kNoFace) {
      const auto said = static_cast<double>(samples.raster_gamma[k]);
      sigma = said < 0 ? -said * (samples.solid_angle_sr[k] * placed_.range2_m2[k]) : said * sigma;
    }
    if (antenna.keeps_elevation()) {
      // That of the surface's middle: of a beam's width, which is 1 / cos(e), it has the mean straight below
      // as well.
      const double height_m = r * sine;
      sine = height_m / std::max(kNearest_m, std::sqrt(dx * dx + dz * dz + height_m * height_m));
    }
    const double power =
        radar_equation(range_constant_, antenna.power_gain(sine, dx, dz, r), sigma, placed_.spreading[k]);
    const int azimuth = samples.azimuth_bin[k] - range_.first;
    const std::size_t bin = BinSums::index(azimuth, range_bin);
    bins_.add(bin, power, power * antenna.kept_sine(sine, dx, dz, r));
    bins_.labels().add(bin, power, samples.material[k], samples.face[k] != kNoFace, [&] {
      return datum_.height_w(dx, dz, power * (at_m.y + r * samples.sin_elevation[k]), power);
    });
    ++binned;
    if (foot_corner_ && samples.face[k] != kNoFace) add_corner(samples, k);
    if (samples.face[k] != kNoFace && samples.face[k] != marked)
      plan_.seen().mark(plan_.scene().world().buildings.building_of_face[marked = samples.face[k]]);
    if (geometric) {
      const double round_trips = 2 * r / plan_.wavelength_m();
      const SinCos at = sincos_turns(-(round_trips - std::floor(round_trips)));
      const double amplitude = std::sqrt(power);
      bins_.add_voltage(bin, amplitude * at.cos, amplitude * at.sin);
    } else {
      const std::uint32_t face = samples.face[k];
      const std::uint64_t ground =
          static_cast<std::uint64_t>(face) << 32 | placed_.level[k] | samples.material[k];
      const glm::dvec3 point_m(samples.x_m[k], at_m.y + r * samples.sin_elevation[k], samples.z_m[k]);
      scatterers_[static_cast<std::size_t>(azimuth)].add(
          static_cast<std::uint32_t>(range_bin),
          face == kNoFace ? ScattererKey(placed_.cell[k], ground)
                          : ScattererKey(speckle_.scatterer(r, point_m, face, samples.material[k])),
          power);
    }
  }
  return binned;
}

/// The texture's mean over each sample, as if all were sea: as wide as a column, and as long as its solid
/// angle makes it on level water.
void EchoBins::texture_samples(const SampleBatch& samples) {
  static_assert(kBatch <= SeaPieces::kMost);
  constexpr double kLeastSine = 1e-3;
  const glm::dvec3& at_m = plan_.sector().antenna_m;
  const double width_rad = plan_.bins().azimuth_width_rad / sweep_columns_per_bin(plan_.settings());
  pieces_->n = samples.n;
  for (int s = 0; s < samples.n; ++s) {
    const auto k = static_cast<std::size_t>(s);
    const double dx = samples.x_m[k] - at_m.x, dz = samples.z_m[k] - at_m.z;
    const double distance_m = std::sqrt(dx * dx + dz * dz), across_m = distance_m * width_rad;
    const double area_m2 = samples.solid_angle_sr[k] * samples.slant_range_m[k] * samples.slant_range_m[k] /
                           std::max(kLeastSine, std::fabs(samples.sin_elevation[k]));
    pieces_->distance_m[k] = static_cast<float>(distance_m);
    pieces_->sine[k] = static_cast<float>(distance_m > 0 ? dx / distance_m : 0);
    pieces_->cosine[k] = static_cast<float>(distance_m > 0 ? dz / distance_m : 1);
    pieces_->across_m[k] = static_cast<float>(across_m);
    pieces_->along_m[k] = static_cast<float>(area_m2 / std::max(across_m, 1e-3));
  }
  active_kernels().sea_texture(*scattering_.texture(), *pieces_);
}

/// What a wall's sample stands for of the wall's corner with the ground.
void EchoBins::add_corner(const SampleBatch& samples, std::size_t k) {
  const auto corner = foot_corner_->at(samples.face[k], samples.x_m[k], samples.z_m[k]);
  if (!corner) return;
  const double r = corner->range_m;
  const int range_bin = plan_.bins().range_bin(r);
  if (range_bin < 0) return;
  const glm::dvec3 off_m = corner->foot_m - plan_.sector().antenna_m;
  const AntennaGain& antenna = plan_.antenna_gain();
  const double sine = off_m.y / r;
  const double spreading = factors_.range_normalisation ? 1 : r * r * r * r;
  const double power = radar_equation(range_constant_, antenna.power_gain(sine, off_m.x, off_m.z, r),
                                      corner->sigma_per_sr * samples.solid_angle_sr[k], spreading);
  const int azimuth = samples.azimuth_bin[k] - range_.first;
  const std::size_t bin = BinSums::index(azimuth, range_bin);
  bins_.add(bin, power, power * antenna.kept_sine(sine, off_m.x, off_m.z, r));
  bins_.labels().add(bin, power, samples.material[k], true,
                     [&] { return datum_.height_w(off_m.x, off_m.z, power * corner->foot_m.y, power); });
  if (plan_.settings().speckle == SpeckleKind::geometric) {
    const double round_trips = 2 * r / plan_.wavelength_m();
    const SinCos at = sincos_turns(-(round_trips - std::floor(round_trips)));
    const double amplitude = std::sqrt(power);
    bins_.add_voltage(bin, amplitude * at.cos, amplitude * at.sin);
    return;
  }
  scatterers_[static_cast<std::size_t>(azimuth)].add(
      static_cast<std::uint32_t>(range_bin),
      ScattererKey(speckle_.corner(r, corner->foot_m, samples.face[k], samples.material[k])), power);
}

void EchoBins::write(BinBlock& block) {
  if (plan_.settings().speckle != SpeckleKind::geometric)
    for (std::size_t azimuth = 0; azimuth < scatterers_.size(); ++azimuth) add_speckle(azimuth);
  bins_.write(block);
}

/// Adds the voltages of an azimuth bin's scatterers.
void EchoBins::add_speckle(std::size_t azimuth) {
  ScattererSums& sums = scatterers_[azimuth];
  std::uint32_t at[BinSums::kBlock] = {};
  sums.merge();
  for (std::size_t first = 0; first < sums.size(); first += BinSums::kBlock) {
    const std::size_t n = std::min(BinSums::kBlock, sums.size() - first);
    for (std::size_t k = 0; k < n; ++k)
      at[k] = sums.range_bin(first + k) * kWedgeAzimuthBins + static_cast<std::uint32_t>(azimuth);
    bins_.add_scatterers(static_cast<int>(n), at, sums.places() + first, sums.kinds() + first,
                         sums.powers_w() + first);
  }
}

std::int64_t EchoBins::bytes(const RadarSettings& s) {
  if (s.speckle == SpeckleKind::geometric) return BinSums::bytes(s.range_bins);
  const int azimuths = std::min(kWedgeAzimuthBins, s.azimuth_bins);
  // The sweep cuts each of its planes at range bins and cells; a spread pixel reaches into some bins.
  const bool sweep = s.frustum == FrustumKind::sweep;
  const double samples = static_cast<double>(s.pixel_columns) / s.azimuth_bins *
                         (sweep ? 4.0 * s.range_bins : 2.0 * s.pixel_rows + s.range_bins);
  // And of one where they are added up.
  return BinSums::bytes(s.range_bins) +
         (azimuths + 1) * ScattererSums::bytes(std::min(samples, cells_in_azimuth_bin(s)));
}

}  // namespace obliq
