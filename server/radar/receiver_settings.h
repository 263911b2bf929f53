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
  bool is_on() const {
    return noise || loss_db != 0 || gain_db != 0 || stc_range_m != 0 || adc_bits != 0;
  }
};

}  // namespace obliq
