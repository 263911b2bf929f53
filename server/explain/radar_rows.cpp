#include "server/explain/radar_rows.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "server/accuracy/truth_bins.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/receiver/video.h"
#include "server/radar/simd/exact_math.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Noise 16 dB below an echo changes its mean power by 0.1 dB.
constexpr double kNoticeable_db = 0.1;
constexpr double kClearOfNoise_db = 16.3;
constexpr double kNoticeableShare = 0.01;
constexpr double kMostDrowned = 0.9;
constexpr int kNothing_db = -99;

/// Of the lit bins of the near, middle and far third of the swath.
using Thirds = std::array<double, 3>;

double range_of(const RadarSettings& s, std::size_t bin) {
  return s.r_min_m + (s.r_max_m - s.r_min_m) * (static_cast<double>(bin) + 0.5) / s.range_bins;
}

std::string thirds_text(const Thirds& db) {
  const auto one = [](double value) -> std::string {
    if (!std::isfinite(value)) return "-";
    return value < kNothing_db ? fmt::format("under {}", kNothing_db) : fmt::format("{:.0f}", value);
  };
  return fmt::format("{}, {}, {} dB", one(db[0]), one(db[1]), one(db[2]));
}

std::vector<double> power_of(const RadarView& view, const RadarSettings& settings) {
  const PlanResult planned = plan_frame(
      view.scene, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}), view.pose);
  if (!planned.plan) throw InputError("radar \"" + view.radar + "\": " + all_text(planned.errors));
  return render_sample(*planned.plan, view.wedges, view.threads, 1, false).power_w;
}

/// The scene's echoes as this radar receives them.
class Echoes {
 public:
  Echoes(const RadarSettings& s, const AirView& air, const std::vector<double>& power_w) {
    const double gain = ratio_of_db(s.gain_db);
    const double factor = s.power_w * gain * gain / ratio_of_db(s.receiver.loss_db);
    const double loss_db_km = path_loss_db_km(s, air);
    const auto n_range = static_cast<std::size_t>(s.range_bins);
    for (std::size_t k = 0; k < power_w.size(); ++k)
      if (const double p = power_w[k] * factor * path_power_factor(loss_db_km, range_of(s, k % n_range));
          p > 0)
        thirds_[3 * (k % n_range) / n_range].push_back(db_of_ratio(p));
    for (auto& third : thirds_) std::ranges::sort(third);
  }

  Thirds median_db() const {
    Thirds db;
    for (std::size_t k = 0; k < 3; ++k) db[k] = thirds_[k].empty() ? NAN : thirds_[k][thirds_[k].size() / 2];
    return db;
  }
  double share_below(double db) const {
    double below = 0, all = 0;
    for (const auto& third : thirds_) {
      below += static_cast<double>(std::ranges::lower_bound(third, db) - third.begin());
      all += static_cast<double>(third.size());
    }
    return all > 0 ? below / all : 0;
  }

 private:
  std::array<std::vector<double>, 3> thirds_;
};

Thirds less(Thirds a, double b) {
  for (double& value : a) value -= b;
  return a;
}

/// What a part of the radar does to the mean power of the bins.
RadarRow part_row(const std::string& name, const std::string& what, const PowerChange& without) {
  const bool counts = without.percentile95_db > kNoticeable_db || without.appeared > kNoticeableShare;
  return {name,
          fmt::format(
              "without {} the bins' mean power changes by {:.1f} dB in the median, more than {:.1f} dB in "
              "a twentieth of them, {:+.1f} dB in all. {}",
              what, without.median_db, without.percentile95_db, without.total_db(),
              counts ? "It is needed." : "It may be left out.")};
}

RadarRow noise_row(const RadarSettings& settings, const Echoes& echoes) {
  RadarSettings with = settings;
  with.receiver.noise = true;
  const double noise_w = noise_power_w(with);
  const double noise_db = db_of_ratio(noise_w);
  const double drowned = echoes.share_below(noise_db);
  const double touched = echoes.share_below(noise_db + kClearOfNoise_db);
  const int looks = settings.video.looks;
  const double one_w = echo_power_w(settings.power_w, settings.gain_db, wavelength_at(settings.frequency_ghz),
                                    settings.receiver.loss_db, 1, settings.r_max_m);
  std::string text = fmt::format(
      "{}: {:.1f} dBW = k T_s B, T_s {:.0f} K, B {} MHz. Clutter to noise, median of the lit bins in the "
      "near, "
      "middle and far third: {}; {:.1f} % of them are below the noise",
      settings.receiver.noise ? "on" : "off", noise_db,
      system_temperature_k(with.receiver.noise_figure_db, with.receiver.antenna_temperature_k),
      short_number(noise_band(with).bandwidth_hz / 1e6, 3), thirds_text(less(echoes.median_db(), noise_db)),
      100 * drowned);
  if (one_w > 0)
    text += fmt::format(
        ". With {} look{} {} m^2 on the boresight can be detected at r_max (Albersheim, Pd 0.9, Pfa 1e-6, "
        "ratio {:.1f} "
        "dB)",
        looks, looks == 1 ? "" : "s",
        short_number(ratio_of_db(detectable_snr_db(looks)) * noise_w / one_w, 2), detectable_snr_db(looks));
  text += touched > kNoticeableShare ? fmt::format(
                                           ". It is needed: it changes {:.0f} % of the lit bins by more "
                                           "than {} dB, and all shadows.",
                                           100 * touched, kNoticeable_db)
                                     : ". It may be left out of the lit bins; shadows need it.";
  if (drowned > kMostDrowned)
    text +=
        " Hardly any ground is above the noise: look at antenna.tilt_deg, radar.power_w and radar.gain_db.";
  return {"noise", text};
}

RadarRow stc_row(const RadarSettings& s, const Echoes& echoes) {
  const Thirds db = echoes.median_db();
  const double fall_db = db[0] - db[2];
  const std::string text =
      std::isfinite(fall_db)
          ? fmt::format("echoes fall by {:.0f} dB from the near to the far third", fall_db)
          : std::string("no echo in the near or the far third of the swath, so that no fall is known");
  if (s.receiver.stc_range_m > 0)
    return {"STC", fmt::format("on: gain {:.1f} dB at r_min, full from {} km on; {}.",
                               stc_gain_db(s.receiver, s.r_min_m),
                               short_number(s.receiver.stc_range_m / 1000, 4), text)};
  return {"STC", fmt::format("off; {}{}.", text,
                             s.range_normalisation ? "; range normalisation makes up for 1/r^4" : "")};
}

RadarRow rain_row(const RadarSettings& settings, const AirView& air, const Echoes& echoes) {
  constexpr double kUsualRain_mm_h = 4;
  RadarSettings with = settings;
  const bool on = settings.atmosphere.rain_mm_h > 0;
  if (!on) with.atmosphere.rain_mm_h = kUsualRain_mm_h;
  RadarSettings without = with;
  without.atmosphere.rain_mm_h = 0;
  const double lost_db =
      2 * (path_loss_db_km(with, air) - path_loss_db_km(without, air)) * with.r_max_m / 1000;
  const std::vector<double> rain_w = rain_echo_power_w(with, air);
  Thirds ratio = echoes.median_db();
  for (std::size_t k = 0; k < 3; ++k)
    ratio[k] = db_of_ratio(std::max(rain_w[(2 * k + 1) * rain_w.size() / 6], 1e-300)) - ratio[k];
  const bool counts = lost_db > kNoticeable_db ||
                      std::ranges::any_of(ratio, [](double db) { return db > -kClearOfNoise_db; });
  return {"rain",
          fmt::format("{}: {} mm/h take {:.1f} dB there and back at r_max; their own echo against the "
                      "ground's, near, middle, far: {}. {}",
                      on ? "on" : "off, but if there were any", short_number(with.atmosphere.rain_mm_h, 3),
                      lost_db, thirds_text(ratio), counts ? "It changes the bins." : "It may be left out.")};
}

RadarRow gas_row(const RadarSettings& s) {
  const double lost_db = 2 * gas_attenuation_db_km(s.frequency_ghz) * s.r_max_m / 1000;
  return {"gas",
          fmt::format("{}: {:.2f} dB there and back at r_max. {}", s.atmosphere.gas ? "on" : "off", lost_db,
                      lost_db > kNoticeable_db ? "It changes the far bins." : "It may be left out.")};
}

RadarRow video_row(const RadarSettings& s) {
  return {"video",
          fmt::format("from {:.0f} dB over {} dB; {} look{}, so that its contrast over even ground is "
                      "{:.2f}.",
                      video_floor_db(s), short_number(s.video.span_db, 4), s.video.looks,
                      s.video.looks == 1 ? "" : "s", 1 / std::sqrt(s.video.looks))};
}

}  // namespace

double detectable_snr_db(int looks) {
  const double a = std::log(0.62 / 1e-6);
  const double b = std::log(0.9 / (1 - 0.9));
  return -5 * std::log10(looks) +
         (6.2 + 4.54 / std::sqrt(looks + 0.44)) * std::log10(a + 0.12 * a * b + 1.7 * b);
}

RadarPowers measure_radar_powers(const RadarView& view, RadarSettings settings) {
  settings.receiver = {};
  settings.atmosphere = {};
  settings.speckle = SpeckleKind::ground;
  RadarPowers powers;
  powers.own_w = power_of(view, settings);
  const RangeBins ranges = range_bins(settings);
  const auto without = [&](auto&& change) {
    RadarSettings changed = settings;
    change(changed);
    return power_change(powers.own_w, power_of(view, changed), ranges);
  };
  if (settings.beam.pattern != BeamPattern::off)
    powers.without_beam = without([](RadarSettings& s) { s.beam.pattern = BeamPattern::off; });
  if (settings.beam.elevation != ElevationPattern::off)
    powers.without_elevation = without([](RadarSettings& s) { s.beam.elevation = ElevationPattern::off; });
  if (settings.pulse.kind != PulseKind::off)
    powers.without_pulse = without([](RadarSettings& s) { s.pulse.kind = PulseKind::off; });
  return powers;
}

std::vector<RadarRow> radar_rows(const RadarSettings& settings, const AirView& air,
                                 const RadarPowers& powers) {
  const Echoes echoes(settings, air, powers.own_w);
  std::vector<RadarRow> rows;
  if (powers.without_beam) rows.push_back(part_row("beam", "the beam", *powers.without_beam));
  if (powers.without_elevation)
    rows.push_back(part_row("elevation", "its pattern in elevation", *powers.without_elevation));
  if (powers.without_pulse) rows.push_back(part_row("pulse", "the pulse", *powers.without_pulse));
  for (RadarRow& row :
       std::vector<RadarRow>{noise_row(settings, echoes), stc_row(settings, echoes),
                             rain_row(settings, air, echoes), gas_row(settings), video_row(settings)})
    rows.push_back(std::move(row));
  return rows;
}

}  // namespace obliq
