#include "server/radar/targets/target_echoes.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "server/radar/geometry/antenna_velocity.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "server/radar/targets/aspect_table.h"
#include "server/radar/targets/seen_share.h"
#include "server/radar/targets/target_motion.h"
#include "terrain/base/asking.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Of the beam at its peak: azimuths with less are left as they are.
constexpr double kLeastGain = 1e-4;
/// What is nearer counts as so near, or the radar equation has no bound.
constexpr double kLeastRange_m = 1;
constexpr int kMostScatterers = 16;
/// In units of ask(): a target's place and line of sight, a look at an echo, a gain or a response, a bin.
constexpr int kTargetWork = 2000;
constexpr int kEchoWork = 5;
constexpr int kGainWork = 40;
constexpr int kBinWork = 4;

SinCos sincos(double angle_rad) { return sincos_turns(angle_rad / kTurn_rad); }

std::complex<double> phasor(double modulus, double turns) {
  const SinCos at = sincos_turns(turns);
  return {modulus * at.cos, modulus * at.sin};
}

}  // namespace

TargetEchoes::TargetEchoes(const FramePlan& plan, const AirView& air, const TargetSet& targets,
                           AzimuthRange azimuths, const TargetLook& look)
    : plan_(plan),
      doppler_(plan.sum() == nullptr ? nullptr : plan.sum()->filter()),
      azimuths_(azimuths),
      at_(look.at),
      draw_{static_cast<std::uint64_t>(targets.seed), look.frame, look.dwell},
      settings_(plan.settings()),
      azimuth_(settings_),
      elevation_(settings_, plan.looks_at().antenna_gain().tilt_rad()),
      response_(settings_),
      beam_(azimuth_, settings_.scan_mode == ScanMode::frame ? 0 : plan.bins().azimuth_width_rad,
            plan.bins().azimuth_width_rad),
      wavelength_m_(wavelength_at(settings_.frequency_ghz)),
      constant_(radar_equation_constant(settings_.power_w, wavelength_m_)),
      gain_(std::pow(10.0, settings_.gain_db / 10)),
      circle_bins_(kTurn_rad / plan.bins().azimuth_width_rad),
      wants_truth_(look.truth),
      moves_s_(look.moves_s) {
  if (attenuates(settings_)) loss_db_km_ = path_loss_db_km(settings_, air);
  for (int m = 0; m < plan.bins().n_range && normalises_samples(settings_); ++m) {
    const double range_m = plan.bins().r_min_m + (m + 0.5) * plan.bins().range_spacing_m;
    range2_m2_.push_back(range_m * range_m);
  }
  for (const Target& target : targets.targets) {
    see(target);
    ask(kTargetWork);
  }
}

void TargetEchoes::see(const Target& target) {
  const Scene& scene = plan_.scene();
  const glm::dvec3& antenna_m = plan_.sector().antenna_m;
  const auto age_s = target_age(target, plan_.pose().settings.sim_time_ns, at_);
  if (!age_s) return;
  const auto place = place_target(scene.world(), target, *age_s);
  if (!place) return;
  const TargetEcho middle = look_at(place->foot_m);
  if (wants_truth_) note_truth(target, *age_s, *place, middle);
  const glm::dvec3 way_m = place->foot_m - antenna_m;
  const double ground_m = std::hypot(way_m.x, way_m.z);
  const TargetPath path = moves_s_ > 0 ? path_of(target, *age_s, *place) : TargetPath{};
  double around_m = target.size.length_m + target.size.width_m;
  if (moves_s_ > 0)
    around_m += moves_s_ * glm::length(path.velocity_m_s - antenna_velocity_m_s(scene.world(), plan_.pose()));
  const double reach_m = response_.reach_bins(plan_.bins().range_spacing_m, settings_.pulse.extent_bins) *
                             plan_.bins().range_spacing_m +
                         around_m;
  const double range_m = glm::length(way_m);
  if (range_m > settings_.r_max_m + reach_m || range_m < settings_.r_min_m - reach_m) return;
  const double aside_bins = around_m < ground_m / 2
                                ? std::asin(around_m / ground_m) / plan_.bins().azimuth_width_rad
                                : circle_bins_;
  if (!reaches(middle, azimuths_, aside_bins)) return;
  const double share = seen_share(scene, antenna_m, place->foot_m, target.size.top_m).share;
  if (!(share > 0)) return;

  const double rcs_m2 = cross_section(target, *place);
  const double closing = doppler_ == nullptr ? 0 : closing_m_s(target, *age_s, *place);
  for (const Scatterer& scatterer : scatterers(target, *place))
    add_scatterer(target.id, scatterer, share * scatterer.part * rcs_m2, closing, path);
}

std::vector<TargetEchoes::Scatterer> TargetEchoes::scatterers(const Target& target,
                                                              const TargetPlace& place) const {
  // One for each half of a range bin or of the beam that it covers as it is seen.
  const glm::dvec3 way_m = place.foot_m - plan_.sector().antenna_m;
  const double ground_m = std::hypot(way_m.x, way_m.z);
  const SinCos nose = sincos(place.heading_rad);
  const double along = ground_m > 0 ? std::abs(way_m.x * nose.sin + way_m.z * nose.cos) / ground_m : 1;
  const double aside = std::sqrt(std::max(0.0, 1 - along * along));
  const double deep_m = std::max(target.size.length_m * along, target.size.width_m * aside);
  const double broad_m = std::max(target.size.length_m * aside, target.size.width_m * along);
  const double cell_rad =
      std::max(plan_.bins().azimuth_width_rad,
               settings_.beam.pattern == BeamPattern::off ? 0 : settings_.beam.width_deg * kDegree_rad);
  const double cells = 2 * std::max(deep_m / plan_.bins().range_spacing_m,
                                    broad_m / (cell_rad * std::max(ground_m, kLeastRange_m)));
  const bool is_of_many = target.size.swerling == 1 || target.size.swerling == 2;
  if (!is_of_many || cells <= 1) {
    const Fluctuation look = fluctuation(target.size.swerling, target.id, draw_);
    return {{place.foot_m,
             1,
             phasor(std::sqrt(look.power), look.phase_turns),
             {target.size.swerling, target.id}}};
  }
  const auto n = static_cast<int>(std::min<double>(kMostScatterers, std::ceil(cells)));
  const std::uint64_t places = target_key(draw_.seed, target.id, 0);
  std::vector<Scatterer> all;
  for (int k = 0; k < n; ++k) {
    // Its place on the target is fixed, and it draws as a target with an id of its own.
    const std::uint64_t own = mix64(places + 16 + static_cast<std::uint64_t>(k));
    const double ahead_m = target.size.length_m * (uniform_of_hash(own) - 0.5);
    const double right_m = target.size.width_m * (turns_of_hash(own) - 0.5);
    const glm::dvec3 at_m = place.foot_m + glm::dvec3(ahead_m * nose.sin + right_m * nose.cos, 0,
                                                      ahead_m * nose.cos - right_m * nose.sin);
    // Swerling 1 keeps the draw of the frame, the phase with it.
    TargetDraw draw = draw_;
    if (target.size.swerling == 1) draw.dwell = 0;
    const Fluctuation look = fluctuation(2, own, draw);
    all.push_back({at_m,
                   1.0 / n,
                   phasor(std::sqrt(look.power), look.phase_turns),
                   {target.size.swerling == 1 ? 1 : 2, own}});
  }
  return all;
}

/// By where it is a moment before and after: along routes, over the ground.
TargetPath TargetEchoes::path_of(const Target& target, double age_s, const TargetPlace& place) const {
  constexpr double kMoment_s = 0.05;
  TargetPath path{place.foot_m, {}, {}};
  const World& world = plan_.scene().world();
  const auto before = place_target(world, target, age_s - kMoment_s);
  const auto after = place_target(world, target, age_s + kMoment_s);
  if (!before || !after) return path;
  path.velocity_m_s = (after->foot_m - before->foot_m) / (2 * kMoment_s);
  path.acceleration_m_s2 =
      (after->foot_m - place.foot_m - (place.foot_m - before->foot_m)) / (kMoment_s * kMoment_s);
  return path;
}

std::complex<double> TargetEchoes::drawn_in_pulse(const TargetEcho& echo, int pulse) const {
  const auto& [swerling, id] = echo.scintillation;
  if (swerling != 2 && swerling != 4) return echo.drawn;
  TargetDraw draw = draw_;
  draw.pulse = static_cast<std::uint64_t>(pulse) + 1;
  const Fluctuation look = fluctuation(swerling, id, draw);
  return phasor(std::sqrt(look.power), look.phase_turns);
}

double TargetEchoes::closing_m_s(const Target& target, double age_s, const TargetPlace& place) const {
  // By what both have done a hundredth of a second later: along routes, straight on, over the ground.
  constexpr double kMoment_s = 0.01;
  const World& world = plan_.scene().world();
  const auto later = place_target(world, target, age_s + kMoment_s);
  const glm::dvec3& antenna_m = plan_.sector().antenna_m;
  const glm::dvec3 way_m = place.foot_m - antenna_m;
  const double range_m = glm::length(way_m);
  if (!later || !(range_m > 0)) return 0;
  const glm::dvec3 by_antenna_m = kMoment_s * antenna_velocity_m_s(world, plan_.pose());
  return -glm::dot(later->foot_m - place.foot_m - by_antenna_m, way_m) / range_m / kMoment_s;
}

void TargetEchoes::note_truth(const Target& target, double age_s, const TargetPlace& place,
                              const TargetEcho& at) {
  const BinGrid& bins = plan_.bins();
  TargetTruth truth;
  if (at.position < bins.n_azimuth) truth.azimuth_bin = static_cast<int>(at.position);
  const bool whole = azimuths_.count >= bins.n_azimuth;
  if (!whole &&
      (truth.azimuth_bin < azimuths_.first || truth.azimuth_bin >= azimuths_.first + azimuths_.count))
    return;
  const glm::dvec3& antenna_m = plan_.sector().antenna_m;
  const glm::dvec3 way_m = place.foot_m - antenna_m;
  truth.id = target.id;
  truth.foot_m = place.foot_m;
  truth.height_m = place.height_m;
  truth.azimuth_rad = at.position * bins.azimuth_width_rad;
  truth.range_m = glm::length(way_m);
  truth.elevation_rad = elevation_rad(place.foot_m, std::max(truth.range_m, kLeastRange_m));
  truth.closing_m_s = closing_m_s(target, age_s, place);
  const double range_bin = std::floor((truth.range_m - bins.r_min_m) / bins.range_spacing_m);
  if (range_bin >= 0 && range_bin < bins.n_range) truth.range_bin = static_cast<int>(range_bin);
  const SeenShare seen = seen_share(plan_.scene(), antenna_m, place.foot_m, target.size.top_m);
  truth.share = seen.share;
  truth.hidden_by = hidden_by(plan_.scene(), antenna_m, place.foot_m, target.size.top_m, seen);
  const double rcs_m2 = cross_section(target, place);
  for (const Scatterer& scatterer : scatterers(target, place)) {
    const double drawn = scatterer.part * std::norm(scatterer.drawn);
    truth.rcs_m2 += drawn * rcs_m2;
    const double range_m = std::max(glm::length(scatterer.at_m - antenna_m), kLeastRange_m);
    truth.power_w += power_w(scatterer.at_m, range_m, drawn * seen.share * rcs_m2);
  }
  truth_.push_back(truth);
}

TargetEcho TargetEchoes::look_at(const glm::dvec3& at_m) const {
  const Sector& sector = plan_.sector();
  const glm::dvec3 way_m = at_m - sector.antenna_m;
  TargetEcho echo;
  echo.range_m = std::max(glm::length(way_m), kLeastRange_m);
  const double ahead = sector.ahead_m(at_m.x, at_m.z), right = sector.right_m(at_m.x, at_m.z);
  double azimuth_rad = bearing_of(right, ahead);
  double sine = std::clamp(way_m.y / echo.range_m, -1.0, 1.0);
  if (const EchoPlan* sum = plan_.sum(); sum != nullptr && sum->ground) {
    const glm::dvec3 own = sum->ground->axes.own(glm::dvec3(ahead, right, way_m.y) / echo.range_m);
    azimuth_rad = bearing_of(own.y, own.x);
    sine = own.z;
  }
  echo.cos_elevation = std::sqrt(std::max(0.0, 1 - sine * sine));
  const BinGrid& bins = plan_.bins();
  const double turns = (azimuth_rad - bins.azimuth_start_rad) / kTurn_rad;
  const double fraction = turns - std::floor(turns);  // may be rounded to 1, which is the seam
  echo.position = fraction < 1 ? fraction * circle_bins_ : 0;
  if (settings_.mode == RadarMode::sar) {
    echo.extent_bins = circle_bins_;
    return echo;
  }
  echo.extent_bins = settings_.beam.pattern == BeamPattern::off
                         ? 1
                         : beam_.extent_rad(echo.cos_elevation) / bins.azimuth_width_rad;
  return echo;
}

double TargetEchoes::elevation_rad(const glm::dvec3& at_m, double range_m) const {
  const glm::dvec3 way_m = at_m - plan_.sector().antenna_m;
  const AntennaGain& table = plan_.looks_at().antenna_gain();
  const ElevationTable& lean = table.elevation();
  const double sine = std::clamp(way_m.y / range_m, -1.0, 1.0);
  return std::asin(std::clamp(
      table.rise() * (sine + (lean.lean_x * way_m.x + lean.lean_z * way_m.z) / range_m), -1.0, 1.0));
}

double TargetEchoes::cross_section(const Target& target, const TargetPlace& place) const {
  double rcs_dbsm = target.size.rcs_dbsm;
  if (target.size.aspects) {
    // As the target sees the antenna: clockwise from its nose, and over its own level.
    const glm::dvec3 way_m = plan_.sector().antenna_m - place.foot_m;
    const double around_rad = bearing_of(way_m.x, way_m.z) - place.heading_rad;
    const double up_rad = std::atan2(way_m.y, std::hypot(way_m.x, way_m.z));
    rcs_dbsm = target.size.aspects->rcs_dbsm(around_rad / kDegree_rad, up_rad / kDegree_rad);
  }
  return std::pow(10.0, rcs_dbsm / 10);
}

double TargetEchoes::power_w(const glm::dvec3& at_m, double range_m, double rcs_m2) const {
  const double antenna = gain_ * elevation_.power_gain(elevation_rad(at_m, range_m));
  const double r2 = range_m * range_m;
  double left = path_power_factor(loss_db_km_, range_m);
  if (settings_.pulse.kind != PulseKind::off && settings_.pulse.eclipse) {
    const double voltage = response_.left_by_eclipse(range_m);
    left *= voltage * voltage;
  }
  return left * radar_equation(constant_, antenna, rcs_m2, r2 * r2);
}

void TargetEchoes::add_scatterer(std::uint64_t id, const Scatterer& scatterer, double rcs_m2,
                                 double closing_m_s, const TargetPath& path) {
  TargetEcho echo = look_at(scatterer.at_m);
  echo.path = path;
  echo.path.at_m = scatterer.at_m;
  echo.drawn = scatterer.drawn;
  echo.scintillation = scatterer.scintillation;
  echo.id = id;
  echo.doppler_hz = 2 * closing_m_s / wavelength_m_;
  echo.power_w = power_w(scatterer.at_m, echo.range_m, rcs_m2);
  const double round_trips = 2 * echo.range_m / wavelength_m_;
  echo.voltage = scatterer.drawn * phasor(std::sqrt(echo.power_w), -(round_trips - std::floor(round_trips)));
  respond(echo);
  if (!echo.responses.empty() || moves_s_ > 0) echoes_.push_back(std::move(echo));
}

double TargetEchoes::bins_away(const TargetEcho& echo, double position) const {
  const double away = position - echo.position;
  return away - circle_bins_ * std::nearbyint(away / circle_bins_);
}

bool TargetEchoes::reaches(const TargetEcho& echo, AzimuthRange azimuths, double aside_bins) const {
  const double middle = azimuths.first + azimuths.count / 2.0;
  return std::abs(bins_away(echo, middle)) <= echo.extent_bins + azimuths.count + aside_bins;
}

double TargetEchoes::azimuth_gain(const TargetEcho& echo, int azimuth, int pulses_before) const {
  // Of an image of synthetic aperture the beam sees all.
  if (settings_.mode == RadarMode::sar) return 1;
  if (settings_.beam.pattern == BeamPattern::off) return static_cast<int>(echo.position) == azimuth ? 1 : 0;
  const double away = bins_away(echo, azimuth + 0.5);
  if (std::abs(away) > echo.extent_bins) return 0;
  const double turned_rad = pulses_before == 0 ? 0 : pulses_before * doppler_->turn_rad();
  return beam_.gain(away * plan_.bins().azimuth_width_rad - turned_rad, echo.cos_elevation);
}

std::complex<double> TargetEchoes::azimuth_weight(const TargetEcho& echo, int azimuth) const {
  const double gain = azimuth_gain(echo, azimuth);
  if (doppler_ == nullptr || std::abs(gain) <= kLeastGain) return gain;
  std::vector<double> gains{gain};
  if (doppler_->is_canceller())
    for (int k = 1; k <= doppler_->delays(); ++k) gains.push_back(azimuth_gain(echo, azimuth, k));
  return doppler_->weight(echo.doppler_hz, echo.range_m, sincos(plan_.sum()->output_middle_rad(azimuth)),
                          gains);
}

/// Nothing where it is beside the swath.
void TargetEchoes::respond(TargetEcho& echo) const {
  const BinGrid& bins = plan_.bins();
  const bool sharp = settings_.pulse.kind == PulseKind::off;
  const int reach = response_.reach_bins(bins.range_spacing_m, settings_.pulse.extent_bins);
  const auto own = static_cast<int>(std::floor((echo.range_m - bins.r_min_m) / bins.range_spacing_m));
  echo.first_range = std::max(0, own - reach);
  for (int m = echo.first_range; m <= std::min(bins.n_range - 1, own + reach); ++m) {
    double response = 1;
    if (!sharp) response = response_.at(bins.r_min_m + (m + 0.5) * bins.range_spacing_m - echo.range_m);
    if (!range2_m2_.empty()) response *= range2_m2_[static_cast<std::size_t>(m)];
    echo.responses.push_back(static_cast<float>(response));
  }
}

template <typename Call>
void TargetEchoes::each_row(const TargetEcho& echo, const BinBlock& bins, const Call& call) const {
  if (!reaches(echo, {bins.first_azimuth, bins.n_azimuth})) return;
  ask(kGainWork * bins.n_azimuth);
  for (int a = 0; a < bins.n_azimuth; ++a) {
    const std::complex<double> gain = azimuth_weight(echo, bins.first_azimuth + a);
    if (std::abs(gain) > kLeastGain)
      call(gain, static_cast<std::size_t>(a) * static_cast<std::size_t>(bins.n_range));
  }
}

void TargetEchoes::add(BinBlock& bins, bool iq) const {
  ask(kEchoWork * static_cast<std::int64_t>(echoes_.size()));
  for (const TargetEcho& echo : echoes_)
    each_row(echo, bins,
             [&](std::complex<double> gain, std::size_t row) { add_to_row(echo, gain, row, bins, iq); });
}

void TargetEchoes::name(BinBlock& bins) const {
  std::vector<double> greatest_w(bins.target.size());
  for (const TargetEcho& echo : echoes_)
    each_row(echo, bins, [&](std::complex<double> gain, std::size_t row) {
      ask(kBinWork * static_cast<std::int64_t>(echo.responses.size()));
      for (std::size_t k = 0; k < echo.responses.size(); ++k) {
        const std::size_t bin = row + static_cast<std::size_t>(echo.first_range) + k;
        const auto response = static_cast<double>(echo.responses[k]);
        const double power_w = echo.power_w * std::norm(gain) * (response * response);
        if (!(power_w > greatest_w[bin])) continue;
        greatest_w[bin] = power_w;
        bins.target[bin] = static_cast<std::uint32_t>(echo.id);
      }
    });
}

void add_targets(const TargetEchoes* targets, BinBlock& bins, bool iq, bool ids) {
  if (ids) bins.target.assign(bins.state.size(), 0);
  if (targets == nullptr) return;
  targets->add(bins, iq);
  if (ids) targets->name(bins);
}

void TargetEchoes::add_to_row(const TargetEcho& echo, std::complex<double> gain, std::size_t row,
                              BinBlock& bins, bool iq) {
  const std::size_t n = echo.responses.size();
  ask(kBinWork * static_cast<std::int64_t>(n));
  const std::size_t first = row + static_cast<std::size_t>(echo.first_range);
  const double power_w = echo.power_w * std::norm(gain);
  for (std::size_t k = 0; k < n; ++k) {
    const auto response = static_cast<double>(echo.responses[k]);
    bins.power_w[first + k] += power_w * (response * response);
  }
  const std::complex<float> voltage(gain * echo.voltage);
  if (iq)
    for (std::size_t k = 0; k < n; ++k) bins.iq[first + k] += echo.responses[k] * voltage;
  if (!bins.look.empty())
    for (std::size_t k = 0; k < n; ++k) bins.look[first + k] += echo.responses[k] * voltage;
}

}  // namespace obliq
