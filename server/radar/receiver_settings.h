#pragma once
#include <cstdint>

namespace obliq {

/// [receiver]: what happens to an echo between the antenna's terminals and the bins.
struct ReceiverSettings {
  bool noise = false;
  double noise_figure_db = 4;
  double antenna_temperature_k = 290;
  double loss_db = 0;  ///< of the echo, there and back; the noise does not feel it
  std::int64_t noise_seed = 1;
  std::uint64_t noise_frame = 0;  ///< counter of frames that no live radar numbers
  double gain_db = 0;
  double stc_range_m = 0;  ///< sensitivity time control ends there; 0: none
  double stc_power = 4;    ///< n of its law (range / stc_range_m)^n, as a power ratio
  double stc_db = 60;      ///< at most
  int adc_bits = 0;        ///< 0: no converter
  double full_scale_dbm = -30;

  /// It changes bins.
  bool is_on() const { return noise || loss_db != 0 || gain_db != 0 || stc_range_m != 0 || adc_bits != 0; }
};

/// [video]: the plane that a display shows.
struct VideoSettings {
  int looks = 1;           ///< pulses that are integrated
  bool floor_auto = true;  ///< the scale begins where receiver/video.h puts it, else at floor_db
  double floor_db = -120;
  double span_db = 100;
  double ftc_us = 0;  ///< fast time constant, the rain knob; 0: none
};

enum class Polarisation { horizontal, vertical };

/// [atmosphere]: what is between the antenna and the ground.
struct AtmosphereSettings {
  double rain_mm_h = 0;      ///< everywhere up to
  double rain_top_m = 4000;  ///< above the datum
  bool gas = false;
  Polarisation polarisation = Polarisation::horizontal;
  double wind_m_s = 0;
  double wind_from_deg = 0;  ///< clockwise from true north
};

/// [sea]: how rough water is.
struct SeaSettings {
  double state = 0;         ///< of Douglas's scale; 0: water returns what its material says
  bool state_auto = false;  ///< instead: that which the wind raises
  double shape = 1;         ///< of the K distribution's texture in a small cell; 0: no texture
};

}  // namespace obliq
