#pragma once
// A radar's receiver: one call on a wedge's bins when all that is about echoes is done.
#include <cstdint>
#include <memory>
#include <string_view>
#include <vector>

#include "server/radar/bins.h"
#include "server/radar/pulse_train.h"
#include "server/radar/receiver/looks_law.h"
#include "server/radar/receiver/video.h"
#include "server/radar/receiver/weather.h"
#include "server/radar/settings.h"

namespace obliq {

/// What a receiver is to make of bins. False: the plane is not wanted and means nothing afterwards.
struct ReceivedPlanes {
  bool iq = true;  ///< video of one look needs it
  bool video8 = false;
  bool video16 = false;
  bool any_video() const { return video8 || video16; }
};

/// Losses, noise, gain, sensitivity time control, converter and, last, range normalisation, in this order.
/// The power plane stays the mean of the echoes: of these, losses and range normalisation change it. What a
/// bin becomes follows from the frame's identity and the bin's own number, so wedges may come in any order,
/// from any thread. Immutable.
class Receiver {
 public:
  /// radar: its name; counter: of the frame. Noise repeats with seed, radar and counter.
  Receiver(const RadarSettings& settings, std::string_view radar, std::uint64_t counter,
           const AirView& air = {});

  /// False: receive() has nothing to do.
  bool is_on() const { return is_on_; }
  std::uint64_t counter() const { return counter_; }
  /// In the middle of the swath; 0 without noise.
  double noise_power_w() const { return noise_power_w_; }
  /// What I and Q are whole multiples of, in their unit; 0: nothing.
  double iq_step() const { return range2_m2_.empty() ? lsb_ : 0; }

  void receive(BinBlock& bins, const ReceivedPlanes& wanted) const;
  /// Each pulse with noise of its own.
  void receive(PulseTrain& train) const;

  const VideoScale& video_scale() const { return video_; }

 private:
  struct Scratch;
  void make_noise(std::uint64_t azimuth, Scratch& scratch) const;
  void receive_row(std::complex<float>* iq, Scratch& scratch) const;
  void integrate_row(const BinBlock& bins, int azimuth, Scratch& scratch, double* power) const;

  bool is_on_;
  std::uint64_t counter_;
  std::uint64_t key_;  ///< of the noise
  double noise_power_w_;
  bool has_noise_;       ///< of the receiver or of rain
  double echo_voltage_;  ///< losses
  std::vector<std::vector<double>> noise_kernels_;
  std::vector<double> noise_voltage_;  ///< [n_range] of noise and rain
  std::vector<double> rain_power_;     ///< [n_range] of rain in the power plane; else empty
  std::vector<double> power_gain_;     ///< [n_range] gain and sensitivity time control
  std::vector<double> voltage_gain_;   ///< [n_range] its root
  std::vector<double> noise_out_w_;    ///< [n_range] the noise's power beside the power plane's
  std::vector<double> range2_m2_;      ///< [n_range] of range normalisation; else empty
  std::vector<double> power_factor_;   ///< [n_range] of the power plane
  VideoScale video_;
  std::shared_ptr<const LooksLaw> looks_;  ///< of video of several looks; else null
  std::vector<double> look_voltage_;       ///< [n_range] what a look is multiplied by
  double lsb_ = 0;                         ///< of the converter, sqrt(W); 0: none
  double most_counts_ = 0;                 ///< its codes go from minus this to this less one
};

/// Sensitivity time control: the gain at a slant range, in dB; 0 or less.
double stc_gain_db(const ReceiverSettings& receiver, double slant_range_m);

/// The converter's step, in sqrt(W): a sine of full scale has the power full_scale_dbm. 0: no converter.
double adc_step(const ReceiverSettings& receiver);

}  // namespace obliq
