#include "server/radar/echo/echo_cells.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "server/radar/simd/kernels.h"
#include "terrain/base/asking.h"
#include "terrain/base/stage_clock.h"

namespace obliq {

namespace {
// In units of ask().
constexpr int kAnEcho = 4;
constexpr int kAPiece = 16;

}  // namespace

EchoCells::EchoCells(const ScenePlan& plan, const ScatteringTable& scattering, const SpeckleField& speckle,
                     Surfaces surfaces, bool voltages, LabelParts labels)
    : plan_(plan),
      speckle_(speckle),
      surfaces_(surfaces),
      bins_(plan, speckle, voltages, labels),
      table_(scattering.echo_table()),
      texture_(scattering.texture()) {
  if (texture_ != nullptr) pieces_ = std::make_unique<SeaPieces>();
  const double gain = plan.antenna_gain().peak();
  table_.factor = radar_equation_constant(plan.settings().power_w, plan.wavelength_m()) * gain * gain;
  table_.range_normalisation = normalises_samples(plan.settings());
  table_.elevation = plan.antenna_gain().elevation();
  table_.sines = plan.antenna_gain().keeps_elevation();
  const glm::dvec3& antenna = plan.sector().antenna_m;
  face_bins_ = {antenna.x, antenna.y, antenna.z, speckle.cells_per_m(), speckle.owners(), {}};
  where_ = {};
  where_.antenna_x_m = antenna.x;
  where_.antenna_z_m = antenna.z;
  const BinGrid& bins = plan.bins();
  for (int bin = 0; bin < bins.n_range; ++bin) {
    const auto octave = static_cast<int>(octave_of((bins.edge_m(bin + 0.0) + bins.edge_m(bin + 1.0)) / 2));
    cells_per_m_.push_back(speckle.cells_per_m()[octave]);
  }
  where_.cells_per_m = cells_per_m_.data();
  if (labels == LabelParts::all) datum_ = {plan.scene().world().frame, {antenna}, plan.sector().r_max_m};
}

void EchoCells::restart(int first_azimuth) {
  bins_.restart(first_azimuth);
  face_bins_.edges = bins_.edges();
  const std::size_t n = BinSums::index(0, plan_.bins().n_range);
  fill(shadow_, n, 0);
  if (bins_.has_voltages()) {
    last_.resize(n);
    std::memset(last_.data(), 0, n * sizeof(LastCell));
  }
  echoes_ = 0;
  faces_.n = 0;
}

void EchoCells::set_bearing(std::size_t profile, SinCos bearing) {
  where_.sin_bearing[profile] = bearing.sin;
  where_.cos_bearing[profile] = bearing.cos;
}

void EchoCells::add(GroundEchoes& echoes) {
  const StageProbe probe(Stage::bin);
  const int n = surfaces_ == Surfaces::buildings ? 0 : echoes.n;
  ask(kAnEcho * n);
  if (texture_ != nullptr && n > 0) {
    ask(kAPiece * n);
    active_kernels().texture_echoes(*texture_, pieces_of_bins(), table_.sea->over_gamma, echoes);
  }
  for (int k = 0; k < n; ++k) {
    const std::uint32_t at = echoes.at[k];
    list_at_[k] = static_cast<std::uint32_t>(
        BinSums::index(static_cast<int>(at % kWedgeAzimuthBins), static_cast<int>(at / GroundEchoes::kRuns)));
    list_power_w_[k] = static_cast<double>(echoes.light[k]) * table_.factor;
  }
  if (bins_.has_voltages() && n > 0) {
    active_kernels().ground_places(where_, echoes, list_place_, list_kind_);
    add_with_voltages(n, echoes.sine);
  } else {
    for (int k = 0; k < n; ++k)
      bins_.add(list_at_[k], list_power_w_[k], static_cast<double>(echoes.sine[k]) * table_.factor);
  }
  echoes.n = 0;
  echoes_ += static_cast<std::uint64_t>(n);
}

PiecesOfBins EchoCells::pieces_of_bins() const {
  const BinGrid& bins = plan_.bins();
  PiecesOfBins of;
  for (std::size_t run = 0; run < GroundEchoes::kRuns; ++run) {
    of.sine[run] = static_cast<float>(where_.sin_bearing[run]);
    of.cosine[run] = static_cast<float>(where_.cos_bearing[run]);
  }
  of.first_m = static_cast<float>(bins.edge_m(0.5));
  of.spacing_m = static_cast<float>(bins.range_spacing_m);
  of.width_rad = static_cast<float>(bins.azimuth_width_rad / sweep_columns_per_bin(plan_.settings()));
  return of;
}

/// What the texture makes of stretches, as of their echoes; of other ground 1.
void EchoCells::texture_of(const GroundStretches& stretches, float* tau) const {
  const PiecesOfBins of = pieces_of_bins();
  SeaPieces& pieces = *pieces_;
  int numbers[SeaPieces::kMost];
  for (int k = 0; k < stretches.n;) {
    pieces.n = 0;
    for (; k < stretches.n && pieces.n < SeaPieces::kMost; ++k) {
      tau[k] = 1;
      if (!(table_.sea->over_gamma[stretches.material(k)] > 0)) continue;
      const std::uint32_t run = stretches.run(k);
      const int to = pieces.n++;
      numbers[to] = k;
      const float distance_m = stretches.from_m[k] + of.spacing_m / 2;
      pieces.distance_m[to] = distance_m;
      pieces.sine[to] = of.sine[run];
      pieces.cosine[to] = of.cosine[run];
      pieces.across_m[to] = distance_m * of.width_rad;
      pieces.along_m[to] = of.along_m(static_cast<float>(stretches.bin(k)), distance_m);
    }
    ask(kAPiece * pieces.n);
    active_kernels().sea_texture(*texture_, pieces);
    for (int to = 0; to < pieces.n; ++to) tau[numbers[to]] = pieces.tau[to];
  }
}

void EchoCells::add(const GroundStretches& stretches) {
  if (surfaces_ == Surfaces::buildings) return;
  const StageProbe probe(Stage::bin);
  const double antenna_y_m = plan_.sector().antenna_m.y;
  ask(kAnEcho * stretches.n);
  // As echoes, so that shares of materials fit their sum.
  float tau[GroundStretches::kMost];
  if (texture_ != nullptr) texture_of(stretches, tau);
  for (int k = 0; k < stretches.n; ++k) {
    const std::uint32_t run = stretches.run(k);
    const double factor = texture_ != nullptr ? table_.factor * static_cast<double>(tau[k]) : table_.factor;
    const double power_w = static_cast<double>(stretches.light[k]) * factor;
    const double y_w = static_cast<double>(stretches.height[k]) * factor + power_w * antenna_y_m;
    const double middle_m = static_cast<double>(stretches.from_m[k] + stretches.end_m[k]) / 2;
    bins_.labels().add(
        BinSums::index(static_cast<int>(run % kWedgeAzimuthBins), static_cast<int>(stretches.bin(k))),
        power_w, stretches.material(k), false, [&] {
          return datum_.height_w(middle_m * where_.sin_bearing[run], middle_m * where_.cos_bearing[run], y_w,
                                 power_w);
        });
  }
}

void EchoCells::add_with_voltages(int n, const float* sine) {
  double re[kList];
  double im[kList];
  ask(BinSums::kAScatterer * n);
  speckle_.respond_ground({n, list_place_, list_kind_, list_power_w_, re, im, list_at_, &bins_.edges()});
  for (int k = 0; k < n; ++k) {
    const std::uint32_t at = list_at_[k];
    const std::uint64_t place = list_place_[k];
    const auto key = static_cast<std::uint32_t>((place >> 32 & 0xfff) << 20 | (place & 0xfff) << 8 |
                                                (list_kind_[k] & 0xff));
    LastCell& last = last_[at];
    const double sine_w = static_cast<double>(sine[k]) * table_.factor;
    const auto amplitude = static_cast<float>(std::sqrt(list_power_w_[k]));
    if (key != last.key || !(last.amplitude > 0)) {
      last = {key, amplitude};
      bins_.add(at, list_power_w_[k], sine_w, re[k], im[k]);
      continue;
    }
    // One scatterer of both powers: what its voltage grows by.
    const float both = std::hypot(last.amplitude, amplitude);
    const double share = static_cast<double>((both - last.amplitude) / amplitude);
    last.amplitude = both;
    bins_.add(at, list_power_w_[k], sine_w, share * re[k], share * im[k]);
  }
}

void EchoCells::add(int profile, const FaceEcho& echo) {
  if (surfaces_ == Surfaces::ground) return;
  put_face(profile, echo,
           table_.elevation.gain == nullptr ? echo.solid_angle_sr
                                            : echo.solid_angle_sr * elevation_gain2(echo.at_m, echo.range_m));
}

void EchoCells::add(int profile, const FacePower& echo) {
  if (surfaces_ == Surfaces::ground || !(echo.power > 0)) return;
  const FaceEcho whole{
      echo.range_bin,         echo.building, echo.face, echo.material, 0, echo.range_m / echo.power, 0,
      echo.at_m / echo.power, echo.corner};
  put_face(profile, whole, echo.power);
}

double EchoCells::power_of(double cross_section_m2, double range_m, const glm::dvec3& at_m) const {
  const double range2 = range_m * range_m;
  const double power = cross_section_m2 / (table_.range_normalisation ? 1 : range2 * range2);
  return table_.elevation.gain == nullptr ? power : power * elevation_gain2(at_m, range_m);
}

double EchoCells::elevation_gain2(const glm::dvec3& at_m, double range_m) const {
  const glm::dvec3 offset = at_m - plan_.sector().antenna_m;
  const double gain = plan_.antenna_gain().power_gain(offset.y / range_m, offset.x, offset.z, range_m) /
                      plan_.antenna_gain().peak();
  return gain * gain;
}

void EchoCells::put_face(int profile, const FaceEcho& echo, double light) {
  const int k = faces_.n++;
  faces_.at[k] = static_cast<std::uint32_t>(BinSums::index(profile, echo.range_bin));
  faces_.material[k] = echo.material;
  faces_.light[k] = light;
  faces_.sec2[k] = echo.sec2_incidence;
  faces_.range_m[k] = echo.range_m;
  if (table_.sines) {
    const glm::dvec3 offset = echo.at_m - plan_.sector().antenna_m;
    face_sine_[k] = plan_.antenna_gain().kept_sine(offset.y / echo.range_m, offset.x, offset.z, echo.range_m);
  }
  if (labels() == LabelParts::all)
    face_height_m_[k] =
        datum_.height_w(echo.at_m.x - where_.antenna_x_m, echo.at_m.z - where_.antenna_z_m, echo.at_m.y, 1);
  if (bins_.has_voltages()) {
    faces_.x_m[k] = echo.at_m.x;
    faces_.y_m[k] = echo.at_m.y;
    faces_.z_m[k] = echo.at_m.z;
    faces_.given[k] = echo.corner ? 1 : 0;
    if (echo.corner)
      put_on_face(k, speckle_.on_corner(echo.range_m, echo.at_m, echo.building, echo.face, echo.material));
    else if (k > 0 && echo.face == face_[k - 1] && faces_.given[k - 1] == 0)
      put_on_same_face(k);
    else
      put_on_face(k, speckle_.on_face(echo.building, echo.face));
    face_[k] = echo.face;
  }
  ++echoes_;
  if (faces_.n == FaceEchoes::kMost) take_faces();
}

void EchoCells::put_on_face(int k, const SpeckleField::OnFace& of) {
  faces_.centre_x_m[k] = of.centre_m.x;
  faces_.centre_y_m[k] = of.centre_m.y;
  faces_.centre_z_m[k] = of.centre_m.z;
  faces_.reach_m[k] = of.reach_m;
  faces_.hash[k] = of.hash;
  faces_.wall[k] = of.wall ? 1 : 0;
}

/// As the one before: a face's echoes come one after the other.
void EchoCells::put_on_same_face(int k) {
  faces_.centre_x_m[k] = faces_.centre_x_m[k - 1];
  faces_.centre_y_m[k] = faces_.centre_y_m[k - 1];
  faces_.centre_z_m[k] = faces_.centre_z_m[k - 1];
  faces_.reach_m[k] = faces_.reach_m[k - 1];
  faces_.hash[k] = faces_.hash[k - 1];
  faces_.wall[k] = faces_.wall[k - 1];
}

void EchoCells::take_faces() {
  ask(BinSums::kAScatterer * faces_.n);
  active_kernels().face_powers(table_, faces_);
  if (bins_.has_voltages()) active_kernels().face_voltages(plan_.wavelength_m(), face_bins_, faces_);
  for (int k = 0; k < faces_.n; ++k) {
    const double sine_w = faces_.power_w[k] * face_sine_[k];
    if (bins_.has_voltages())
      bins_.add(faces_.at[k], faces_.power_w[k], sine_w, faces_.re[k], faces_.im[k]);
    else
      bins_.add(faces_.at[k], faces_.power_w[k], sine_w);
    bins_.labels().add(faces_.at[k], faces_.power_w[k], static_cast<std::uint8_t>(faces_.material[k]), true,
                       [&] { return faces_.power_w[k] * face_height_m_[k]; });
  }
  faces_.n = 0;
}

void EchoCells::write(BinBlock& block) {
  take_faces();
  bins_.write(block);
  std::size_t bin = 0;
  for (int a = 0; a < block.n_azimuth; ++a)
    for (int r = 0; r < block.n_range; ++r, ++bin)
      if (block.count[bin] == 0 && shadow_[BinSums::index(a, r)] != 0)
        block.state[bin] = static_cast<std::uint8_t>(BinState::shadow);
}

}  // namespace obliq
