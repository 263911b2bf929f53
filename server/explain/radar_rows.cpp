// What is between echoes and display.
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "server/explain/explanation.h"
#include "server/radar/receiver/noise.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/receiver/video.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// Noise 16 dB below an echo changes its mean power by 0.1 dB.
constexpr double kNoticeable_db = 0.1;
constexpr double kClearOfNoise_db = 16.3;
constexpr double kMostDrowned = 0.9;

/// What a radar may lack. `take_out` says whether this one has it.
struct Part {
  const char* name;
  const char* words;
  bool (*take_out)(RadarSettings& settings);
};
constexpr Part kParts[] = {
    {"beam", "the beam",
     [](RadarSettings& s) { return std::exchange(s.beam.pattern, BeamPattern::off) != BeamPattern::off; }},
    {"elevation", "its pattern in elevation",
     [](RadarSettings& s) {
       return std::exchange(s.beam.elevation, ElevationPattern::off) != ElevationPattern::off;
     }},
    {"pulse", "the pulse",
     [](RadarSettings& s) { return std::exchange(s.pulse.kind, PulseKind::off) != PulseKind::off; }},
};

/// Of the lit bins of the near, middle and far third of the swath.
using Thirds = std::array<double, 3>;

std::string thirds_text(const Thirds& db, double less_db = 0) {
  constexpr int kNothing_db = -99;
  std::string text;
  for (const double value : db)
    text += (text.empty() ? "" : ", ") +
            (value - less_db < kNothing_db ? "under -99" : number_text(value - less_db, ".0f"));
  return text + " dB";
}

/// The scene's echoes as this radar receives them.
class Echoes {
 public:
  Echoes(const RadarSettings& s, const AirView& air, const std::vector<double>& power_w) {
    const double gain = ratio_of_db(s.gain_db);
    const double factor = s.power_w * gain * gain / ratio_of_db(s.receiver.loss_db);
    const double loss_db_km = path_loss_db_km(s, air);
    const RangeBins ranges = range_bins(s);
    const auto n_range = static_cast<std::size_t>(s.range_bins);
    for (std::size_t k = 0; k < power_w.size(); ++k) {
      const std::size_t bin = k % n_range;
      const double r_m = ranges.centre_m(static_cast<int>(bin));
      const double p_w = power_w[k] * factor * path_power_factor(loss_db_km, r_m);
      if (p_w > 0) thirds_[3 * bin / n_range].push_back(db_of_ratio(p_w));
    }
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

/// Signal-to-noise ratio of one pulse, in dB, at which a steady target is found with probability 0.9 at a
/// false alarm probability of 1e-6 when so many looks are integrated: Albersheim's equation (Proc. IEEE 69,
/// 1981; to 0.2 dB).
double steady_snr_db(int looks) {
  const double a = std::log(0.62 / 1e-6);
  const double b = std::log(0.9 / (1 - 0.9));
  return -5 * std::log10(looks) +
         (6.2 + 4.54 / std::sqrt(looks + 0.44)) * std::log10(a + 0.12 * a * b + 1.7 * b);
}

}  // namespace

std::vector<ReportRow> radar_rows(const RadarSettings& s, const AirView& air,
                                  const std::function<std::vector<double>(const RadarSettings&)>& power_of) {
  RadarSettings plain = s;  // mean echoes of 1 W and 0 dB
  plain.mode = RadarMode::map;
  plain.receiver = {};
  plain.atmosphere.rain_mm_h = 0;
  plain.atmosphere.gas = false;
  plain.sea.shape = 0;
  plain.speckle = SpeckleKind::ground;
  plain.range_normalisation = false;
  plain.power_w = 1;
  plain.gain_db = 0;
  const std::vector<double> own_w = power_of(plain);
  std::vector<ReportRow> rows;
  for (const Part& part : kParts) {
    RadarSettings without = plain;
    if (!part.take_out(without)) continue;
    const PowerChange change = power_change(own_w, power_of(without), range_bins(plain));
    const bool counts = change.percentile95_db > kNoticeable_db || change.appeared > kNoticeableShare;
    rows.push_back(
        {part.name,
         text_of(
             values("part"_is = part.words, "median_db"_is = change.median_db,
                    "percentile95_db"_is = change.percentile95_db, "total_db"_is = change.total_db()),
             {{part.name, true,
               "without {part} the bins' mean power changes by {median_db:.1f} dB in the median, more than "
               "{percentile95_db:.1f} dB in a twentieth of them, {total_db:+.1f} dB in all. "},
              {part.name, true, counts ? "It is needed." : "It may be left out."}})});
  }

  const Echoes echoes(s, air, own_w);
  const Thirds echo_db = echoes.median_db();
  RadarSettings noisy = s;
  noisy.receiver.noise = true;
  const double noise_w = noise_power_w(noisy, air), noise_db = db_of_ratio(noise_w);
  const double drowned = echoes.share_below(noise_db);
  const double touched = echoes.share_below(noise_db + kClearOfNoise_db);
  const double ratio_db = steady_snr_db(s.video.looks);
  const double metre_w =
      echo_power_w(s.power_w, s.gain_db, wavelength_at(s.frequency_ghz), s.receiver.loss_db, 1, s.r_max_m);

  constexpr double kUsualRain_mm_h = 4;
  RadarSettings wet = s, dry = s;
  const bool rains = s.atmosphere.rain_mm_h > 0;
  if (!rains) wet.atmosphere.rain_mm_h = kUsualRain_mm_h;
  dry.atmosphere.rain_mm_h = 0;
  const double way_km = 2 * s.r_max_m / 1000;
  const double rain_db = way_km * (path_loss_db_km(wet, air) - path_loss_db_km(dry, air));
  const double gas_db = way_km * gas_attenuation_db_km(s.frequency_ghz);
  const std::vector<double> rain_w = rain_echo_power_w(wet, air);
  Thirds rain_to_echo_db;
  for (std::size_t k = 0; k < 3; ++k)
    rain_to_echo_db[k] = db_of_ratio(std::max(rain_w[(2 * k + 1) * rain_w.size() / 6], 1e-300)) - echo_db[k];
  const bool rain_counts = rain_db > kNoticeable_db || std::ranges::any_of(rain_to_echo_db, [](double db) {
                             return db > -kClearOfNoise_db;
                           });
  const double fall_db = echo_db[0] - echo_db[2];
  const bool stc = s.receiver.stc_range_m > 0, fall_known = std::isfinite(fall_db);

  const Values measured = values(
      "noise"_is = s.receiver.noise ? "on" : "off", "noise_db"_is = noise_db,
      "system_k"_is = system_temperature_k(s.receiver.noise_figure_db, s.receiver.antenna_temperature_k),
      "band_mhz"_is = noise_band(noisy).bandwidth_hz / 1e6, "clutter"_is = thirds_text(echo_db, noise_db),
      "drowned"_is = 100 * drowned, "touched"_is = 100 * touched, "noticeable_db"_is = kNoticeable_db,
      "looks"_is = counted(static_cast<std::uint64_t>(s.video.looks), "look"), "ratio_db"_is = ratio_db,
      "least_m2"_is = ratio_of_db(ratio_db) * noise_w / metre_w,
      "stc_db"_is = stc_gain_db(s.receiver, s.r_min_m), "stc_km"_is = s.receiver.stc_range_m / 1000,
      "fall_db"_is = fall_db, "rain"_is = rains ? "on" : "off, but if there were any",
      "rain_mm_h"_is = wet.atmosphere.rain_mm_h, "rain_db"_is = rain_db,
      "rain_to_echo"_is = thirds_text(rain_to_echo_db), "gas"_is = s.atmosphere.gas ? "on" : "off",
      "gas_db"_is = gas_db, "floor_db"_is = video_floor_db(s, air), "span_db"_is = s.video.span_db,
      "contrast"_is = 1 / std::sqrt(s.video.looks));
  for (ReportRow& row : rows_of(
           measured,
           {{"noise", true,
             "{noise}: {noise_db:.1f} dBW = k T_s B, T_s {system_k:.0f} K, B {band_mhz:3} MHz. Clutter to "
             "noise, median of the lit bins in the near, middle and far third: {clutter}; {drowned:.1f} % of "
             "them are below the noise"},
            {"noise", metre_w > 0,
             ". With {looks} {least_m2:2} m^2 on the boresight can be detected at r_max (Albersheim, Pd 0.9, "
             "Pfa 1e-6, ratio {ratio_db:.1f} dB)"},
            {"noise", true,
             touched > kNoticeableShare
                 ? ". It is needed: it changes {touched:.0f} % of the lit bins by more than {noticeable_db} "
                   "dB, and all shadows."
                 : ". It may be left out of the lit bins; shadows need it."},
            {"noise", drowned > kMostDrowned,
             " Hardly any ground is above the noise: look at antenna.tilt_deg, radar.power_w and "
             "radar.gain_db."},
            {"STC", stc, "on: gain {stc_db:.1f} dB at r_min, full from {stc_km:4} km on; "},
            {"STC", !stc, "off; "},
            {"STC", true,
             fall_known ? "echoes fall by {fall_db:.0f} dB from the near to the far third"
                        : "no echo in the near or the far third of the swath, so that no fall is known"},
            {"STC", !stc && s.range_normalisation, "; range normalisation makes up for 1/r^4"},
            {"STC", true, "."},
            {"rain", true,
             "{rain}: {rain_mm_h:3} mm/h take {rain_db:.1f} dB there and back at r_max; their own echo "
             "against "
             "the ground's, near, middle, far: {rain_to_echo}. "},
            {"rain", true, rain_counts ? "It changes the bins." : "It may be left out."},
            {"gas", true, "{gas}: {gas_db:.2f} dB there and back at r_max. "},
            {"gas", true, gas_db > kNoticeable_db ? "It changes the far bins." : "It may be left out."},
            {"video", true,
             "from {floor_db:.0f} dB over {span_db:4} dB; {looks}, so that its contrast over even ground is "
             "{contrast:.2f}."}}))
    rows.push_back(std::move(row));
  return rows;
}

}  // namespace obliq
