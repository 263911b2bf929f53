#pragma once
// The receiver's noise: its power, and how the pulse colours it.
#include <vector>

#include "server/radar/receiver/weather.h"
#include "server/radar/settings.h"

namespace obliq {

/// What the noise follows from of the pulse: the receiver is matched to it.
struct NoiseBand {
  double bandwidth_hz = 0;  ///< 1 / pulse length
  double window_loss = 1;   ///< L_w, a power ratio: of a windowed compression against the matched filter
};

/// Without a pulse: c / 2 over the range bin, the band that the bins just resolve.
NoiseBand noise_band(const RadarSettings& settings);

/// T_s = T_a + T_0 (F - 1) (IEEE Std 145: noise figure F at the reference temperature T_0, 290 K), in kelvin.
double system_temperature_k(double noise_figure_db, double antenna_temperature_k, double reference_k = 290);

/// N = k T_s L_w B, in watts: behind a matched filter that leaves a point target the power that the radar
/// equation gives it. SNR = S / N is then that of Richards 2014, eq. 2.26, for a pulse of length 1 / B.
double noise_power_w(double temperature_k, const NoiseBand& band);

/// Of a radar at a slant range, behind its Doppler filter; 0 where it has no noise. The train of a synthetic
/// aperture, T(r), has prf_hz T pulses, so that an image's noise falls with range and with a slower flight.
double noise_power_w(const RadarSettings& settings, const AirView& air, double slant_range_m);
/// In the middle of the swath.
double noise_power_w(const RadarSettings& settings, const AirView& air = {});

/// P_t G^2 lambda^2 sigma / ((4 pi)^3 L r^4), in watts: the radar equation (Richards 2014, eq. 2.8, with
/// losses). Gain one way, loss there and back.
double echo_power_w(double power_w, double gain_db, double wavelength_m, double loss_db,
                    double cross_section_m2, double slant_range_m);

/// How the receiver colours its noise in range: filters of independent white noises whose outputs add up to
/// noise of mean square 1. Without a pulse {{1}}. Behind the matched filter of a rectangular pulse its
/// autocorrelation is the triangle of the pulse itself, exactly at whole bins; behind a compressed one that
/// of the point response, p * p.
std::vector<std::vector<double>> noise_kernels(const RadarSettings& settings);

}  // namespace obliq
