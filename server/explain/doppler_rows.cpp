// What `obliq explain` says of a radar's mode.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <string>

#include "server/explain/explanation.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/doppler/canceller.h"
#include "server/radar/doppler/wind.h"
#include "server/radar/echo/sea_echo.h"
#include "server/radar/pulses/pulse_times.h"
#include "server/radar/pulses/render_train.h"
#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kLight_m_s = 299792458.0;

/// Average gain times clutter attenuation of a canceller over echoes whose correlation after k pulses is
/// rho[k] (Skolnik 2008, chapter 2); infinite where they stand still.
double improvement_db(int delays, const ByLag& rho) {
  const ByLag weights = canceller_autocorrelation(delays);
  const double left = std::inner_product(weights.begin(), weights.end(), rho.begin(), 0.0);
  constexpr double kOfDoubles = 1e-14;
  return left > kOfDoubles ? -db_of_ratio(left) : INFINITY;
}

/// Correlation of the ground under an antenna that turns, `pulses` of them a Gaussian beamwidth.
ByLag turning(double pulses) {
  ByLag rho{1};
  for (std::size_t k = 1; k < rho.size(); ++k)
    rho[k] = std::exp(-2 * std::numbers::ln2 * std::pow(static_cast<double>(k) / pulses, 2));
  return rho;
}

/// Correlation of the ground under an antenna that flies: `cells` are those of one pulse interval in a
/// Gaussian beam.
ByLag flying(double cells) {
  // The clutter's sigma: of g^2 over the beam, in half power widths of g.
  const double sigma = cells / (4 * std::sqrt(std::numbers::ln2));
  ByLag rho{1};
  for (std::size_t k = 1; k < rho.size(); ++k)
    rho[k] = std::exp(-2 * std::pow(std::numbers::pi * sigma * static_cast<double>(k), 2));
  return rho;
}

ByLag blown(const RadarSettings& s) {
  const WindSpectrum wind(s.atmosphere.wind_m_s, s.frequency_ghz);
  ByLag rho{1};
  for (std::size_t k = 1; k < rho.size(); ++k)
    rho[k] = 1 - wind.moving * (1 - wind.correlation(static_cast<double>(k) / s.pulse.prf_hz,
                                                     wavelength_at(s.frequency_ghz)));
  return rho;
}

/// Where it closes by its mean.
ByLag rough(const RadarSettings& s) {
  const SeaMotion sea(s);
  const double wavelength_m = wavelength_at(s.frequency_ghz);
  ByLag rho{1};
  for (std::size_t k = 1; k < rho.size(); ++k) {
    const double lag_s = static_cast<double>(k) / s.pulse.prf_hz;
    rho[k] = sea.correlation(lag_s, wavelength_m) *
             std::cos(4 * std::numbers::pi * sea.downwind_m_s * lag_s / wavelength_m);
  }
  return rho;
}

std::string db_text(double db) {
  return std::isfinite(db) ? number_text(db, ".1f") + " dB" : std::string("unlimited");
}

struct Limit {
  const char* by;
  double db;
};

ReportRow canceller_row(const FramePlan& plan) {
  const RadarSettings& s = plan.settings();
  const SeaMotion sea(s);
  const DopplerPlan& doppler = *plan.sum()->doppler;
  const int c = s.doppler.canceller;
  const double beam_rad = azimuth_resolution_rad(s);
  const double across_m_s = doppler.velocity().across_m_s(0);
  const double cells = 2 * across_m_s * beam_rad / wavelength_at(s.frequency_ghz) / s.pulse.prf_hz;
  const bool turns = doppler.turn_rad() > 0;
  const double pulses = turns ? beam_rad / doppler.turn_rad() : 0;
  const Limit limits[] = {{"its turning", turns ? improvement_db(c, turning(pulses)) : INFINITY},
                          {"its flight", improvement_db(c, flying(cells))},
                          {"the wind", doppler.windy().empty() ? INFINITY : improvement_db(c, blown(s))},
                          {"the sea", doppler.has_sea() ? improvement_db(c, rough(s)) : INFINITY}};
  const Limit& least = *std::ranges::min_element(limits, {}, &Limit::db);
  const double middle_hz = doppler.ground().level_hz({0, 1});
  const double own_m_s = middle_hz * wavelength_at(s.frequency_ghz) / 2;
  return {
      "mti",
      text_of(
          values("delays"_is = counted(static_cast<std::uint64_t>(c), "delay"), "prf_hz"_is = s.pulse.prf_hz,
                 "blind_m_s"_is = wavelength_at(s.frequency_ghz) * s.pulse.prf_hz / 2,
                 "range_km"_is = kLight_m_s / (2 * s.pulse.prf_hz) / 1000, "r_max_km"_is = s.r_max_m / 1000,
                 "turning"_is = db_text(limits[0].db), "pulses"_is = pulses,
                 "flying"_is = db_text(limits[1].db), "speed_m_s"_is = across_m_s,
                 "wind"_is = db_text(limits[2].db), "sea"_is = db_text(limits[3].db),
                 "sea_m_s"_is = sea.downwind_m_s, "sea_deviation_m_s"_is = sea.deviation_m_s,
                 "least"_is = db_text(least.db), "by"_is = least.by, "own_m_s"_is = own_m_s),
          {{"mti", true,
            "a canceller of {delays} at {prf_hz:6} Hz: speeds of {blind_m_s:.2f} m/s and its multiples "
            "are blind, ranges unambiguous to {range_km:.1f} km (r_max is {r_max_km:.1f}). "},
           {"mti", turns, "Turning, {pulses:.1f} pulses a beamwidth: it improves by {turning}. "},
           {"mti", cells > 0, "Flying, {speed_m_s:.1f} m/s across the beam: {flying}. "},
           {"mti", !doppler.windy().empty(), "Woods and grass in the wind: {wind}. "},
           {"mti", doppler.has_sea(),
            "The sea, upwind {sea_m_s:.2f} m/s with a deviation of {sea_deviation_m_s:.2f}: {sea}. "},
           {"mti", std::isfinite(least.db), "Of these {by} limits it: {least}. "},
           {"mti", !std::isfinite(least.db), "Ground that stands still leaves nothing. "},
           {"mti", !doppler.has_lock() && std::abs(own_m_s) > 1,
            "The ground in the beam's middle closes at {own_m_s:.0f} m/s: doppler.clutter_lock = true "
            "brings the notch there. "}})};
}

ReportRow sharpening_row(const FramePlan& plan) {
  const RadarSettings& s = plan.settings();
  const SeaMotion sea(s);
  const DopplerPlan& doppler = *plan.sum()->doppler;
  const double train_s = coherent_time_s(s);
  const double beam_rad = narrowest_beam_rad(s);
  const double sector_rad = s.sector_deg * kDegree_rad;
  const auto ratio = [&](double azimuth_rad) {
    return cells_in_beam(s, beam_rad, doppler.velocity().across_m_s(azimuth_rad));
  };
  const double most = cells_in_beam(s, beam_rad, doppler.velocity().most_across_m_s(sector_rad));
  const double width_hz = most / train_s;
  const double rows = beam_rad * plan.sum()->azimuth_parts / s.azimuth_bin_rad();
  return {
      "dbs",
      text_of(
          values("pulses"_is = s.doppler.pulses, "prf_hz"_is = s.pulse.prf_hz, "train_ms"_is = 1000 * train_s,
                 "left"_is = ratio(-sector_rad / 2), "middle"_is = ratio(0),
                 "right"_is = ratio(sector_rad / 2), "most"_is = most, "rows"_is = rows,
                 "needed"_is = most + 3, "cell_deg"_is = beam_rad / kDegree_rad / std::max(1.0, ratio(0)),
                 "sea_m_s"_is = sea.downwind_m_s, "sea_deviation_m_s"_is = sea.deviation_m_s,
                 "sea_cells"_is = sea.deviation_hz(wavelength_at(s.frequency_ghz)) * train_s,
                 "width_hz"_is = width_hz, "range_km"_is = kLight_m_s / (2 * s.pulse.prf_hz) / 1000),
          {{"dbs", true,
            "{pulses:4} pulses at {prf_hz:6} Hz, {train_ms:.1f} ms: the beam becomes {left:.1f}, "
            "{middle:.1f} and {right:.1f} times as narrow at the sector's left, middle and right; "
            "{rows:.1f} rows a beamwidth, B + 3 = {needed:.1f} are needed. "},
           {"dbs", doppler.has_sea(),
            "The sea is smeared over {sea_cells:.1f} cells either way, {sea_deviation_m_s:.2f} m/s; upwind "
            "it "
            "closes at {sea_m_s:.2f} m/s. "},
           {"dbs", !(most > 1),
            "Nothing flies across the beam: the map is the real beam's. antenna.velocity_* says how it "
            "flies. "},
           {"dbs", width_hz > s.pulse.prf_hz,
            "The ground in the beam is {width_hz:.0f} Hz wide, more than the PRF: azimuths are "
            "ambiguous. "}})};
}

ReportRow image_row(const FramePlan& plan) {
  const RadarSettings& s = plan.settings();
  const SeaMotion sea(s);
  const DopplerPlan& doppler = *plan.sum()->doppler;
  const double middle_m = (s.r_min_m + s.r_max_m) / 2;
  return {"sar",
          text_of(values("resolution_m"_is = s.doppler.resolution_m,
                         "speed_m_s"_is = doppler.velocity().across_m_s(0),
                         "time_s"_is = doppler.turns_a_hz(middle_m), "range_km"_is = middle_m / 1000,
                         "length_m"_is = doppler.turns_a_hz(middle_m) * doppler.velocity().across_m_s(0),
                         "prf_hz"_is = s.pulse.prf_hz, "sea_m_s"_is = sea.downwind_m_s,
                         "sea_deviation_m_s"_is = sea.deviation_m_s,
                         "smear_m"_is = std::min(kMostSeaSmear.spread_rad,
                                                 sea.deviation_m_s / doppler.velocity().across_m_s(0)) *
                                        middle_m,
                         "pulses"_is = doppler.turns_a_hz(middle_m) * s.pulse.prf_hz),
                  {{"sar", true,
                    "{resolution_m:3} m across range: {time_s:.2f} s of flight at {speed_m_s:.1f} m/s, an "
                    "aperture of {length_m:.0f} m at {range_km:.1f} km; of its {pulses:.0f} pulses at "
                    "{prf_hz:6} Hz the "
                    "noise is added up. "},
                   {"sar", doppler.has_sea(),
                    "The sea is smeared over {smear_m:.0f} m either way, {sea_deviation_m_s:.2f} m/s; upwind "
                    "it closes at "
                    "{sea_m_s:.2f} m/s. "}})};
}

ReportRow train_row(const FramePlan& plan) {
  const RadarSettings& s = plan.settings();
  const PulseTimes times(s);
  const double mean_s = times.pattern_s() / times.pattern();
  const double beam_rad = narrowest_beam_rad(s);
  const double across_m_s = plan.sum()->doppler->velocity().most_across_m_s(s.sector_deg * kDegree_rad);
  const double unambiguous_m =
      range_of_delay_m(*std::min_element(times.intervals_s().begin(), times.intervals_s().end()));
  const double seen_m = farthest_seen_m(plan.scene(), plan.pose());
  const double cells = cells_in_beam(s, beam_rad, across_m_s);
  return {
      "pulses",
      text_of(
          values("pulses"_is = s.doppler.pulses, "prf_hz"_is = 1 / mean_s,
                 "train_ms"_is = 1000 * times.length_s(), "cells"_is = cells,
                 "rows"_is = beam_rad / plan.sum()->row_rad(),
                 "speed_m_s"_is = wavelength_at(s.frequency_ghz) / (2 * mean_s),
                 "cell_m_s"_is = wavelength_at(s.frequency_ghz) / (2 * mean_s * s.doppler.pulses),
                 "range_km"_is = unambiguous_m / 1000, "r_max_km"_is = s.r_max_m / 1000,
                 "seen_km"_is = seen_m / 1000),
          {{"pulses", true,
            "{pulses:4} pulses at {prf_hz:.6g} Hz, {train_ms:.1f} ms: radial speeds are unambiguous over "
            "{speed_m_s:.1f} m/s in cells of {cell_m_s:.2f} m/s. The ground in the beam has B = {cells:.1f} "
            "cells, {rows:.1f} rows a beamwidth, B + 3 are needed. "},
           {"pulses", unambiguous_m >= seen_m,
            "Ranges are unambiguous to {range_km:.1f} km, and nothing is seen beyond {seen_km:.1f}. "},
           {"pulses", unambiguous_m < seen_m,
            "Ranges are unambiguous to {range_km:.1f} km (r_max is {r_max_km:.1f}), and ground is seen to "
            "{seen_km:.1f}: what lies beyond comes back in the next pulses' time. "}})};
}

}  // namespace

std::vector<ReportRow> doppler_rows(const FramePlan& plan) {
  std::vector<ReportRow> rows;
  if (plan.settings().mode == RadarMode::mti) rows.push_back(canceller_row(plan));
  if (plan.settings().mode == RadarMode::dbs) rows.push_back(sharpening_row(plan));
  if (plan.settings().mode == RadarMode::sar) rows.push_back(image_row(plan));
  if (plan.settings().mode == RadarMode::pulses) rows.push_back(train_row(plan));
  for (ReportRow& row : rows)
    if (row.text.ends_with(' ')) row.text.pop_back();
  return rows;
}

}  // namespace obliq
