#pragma once
// The ground's echoes in a train of pulses. A row b of sharp bins turns as its middle does:
//   x[n] = q[n] sum over b of g(th_b - th(t_n)) v_b exp(j 2 pi f_b t_n)
// with f_b of GroundDoppler, the beam's one-way gain g, and the quadratic phase of the beam's middle as the
// antenna passes, q = exp(-j (4 pi / lambda) (v_across t)^2 / 2r); then the pulse's sum over ranges.
#include <cstdint>
#include <vector>

#include "server/radar/beam/beam_on_ground.h"
#include "server/radar/beam/echo_rows.h"
#include "server/radar/frame_plan.h"
#include "server/radar/pulse_train.h"
#include "server/radar/pulses/boresight.h"
#include "server/radar/pulses/pulse_times.h"

namespace obliq {

/// Of one trip: of the echoes in a plan's swath. Holds its buffers; one thread at a time.
class GroundPulses {
 public:
  /// All must outlive it.
  GroundPulses(const FramePlan& plan, const PulseTimes& times, const Boresight& boresight);

  /// The rows that the beam sees in the train, as an azimuth 0 that is made of them.
  const RowWindow& rows() const { return window_; }
  /// Azimuth bins of the plan that hold the beam's middle.
  AzimuthRange azimuths() const { return azimuths_; }

  /// To the gates of a train, first the trip's nearest, in PulseTrip::pulses. key: of what is drawn anew in
  /// each train. At most the sums' plan's ranges are written.
  void add(const EchoRows::Ready& rows, const PulseTrip& trip, std::uint64_t key, PulseTrain& train);

 private:
  /// A row's Doppler and voltages.
  struct Row {
    std::vector<double> hz;
    std::vector<float> re, im;
  };
  void place_rows();
  void set_iq(Row& row, const float* iq) const;
  void take(const SharpWedge& wedge, int azimuth, std::uint64_t key, std::vector<Row>& all);
  void add_moving(int azimuth, std::vector<float> power, int number, std::uint64_t key,
                  const std::vector<double>& hz, Row& moving) const;
  void add_sea(int azimuth, const std::vector<float>& power, int number, std::uint64_t key,
               const std::vector<double>& hz, Row& sea) const;
  void draw_moving(int azimuth, const std::vector<float>& power, std::uint64_t key, Row& moving) const;
  void cut_by_eclipse(const PulseTrip& trip);
  void sum_rows(const EchoRows::Ready& rows, std::size_t first_row, const PulseTrip& trip,
                const std::vector<Row>& all, int parts);
  /// Of a row at a cosine of elevation: one of each pulse in the order of like ones, or one for all.
  const float* gains(std::size_t row, int step);
  double level(int step);
  void turn_pulses(const PulseTrip& trip);
  void sum_ranges(int pulse, PulseTrain& train);
  float* pulse_row(std::vector<float>& of, int pulse) {
    return of.data() + static_cast<std::size_t>(pulse) * row_floats_;
  }

  const FramePlan& plan_;
  const EchoPlan& sum_;
  const PulseTimes& times_;
  const Boresight boresight_;
  const AzimuthPattern pattern_;
  const BeamOnGround beam_;
  const std::size_t stride_;
  const std::size_t pad_;         // bins before a row, zeros
  const std::size_t row_floats_;  // of a pulse
  RowWindow window_;
  AzimuthRange azimuths_;
  int speeds_ = 0;                         // that a row's bins have of what moves in the wind
  int sea_speeds_ = 0;                     // and of the sea
  double moving_hz_ = 0;                   // of a speed of 1 / beta (WindSpectrum)
  double sea_hz_ = 0;                      // of the sea's standard deviation
  std::vector<double> turns_a_s2_;         // [stride] of the quadratic phase
  std::vector<int> first_of_like_;         // where the gains of pulses like k begin
  std::vector<double> levels_;             // by step: what makes the squares of its gains add up to 1
  std::vector<std::vector<float>> gains_;  // [rows][steps], as they are needed
  std::vector<float> eclipsed_;            // [stride] of voltages, what the transmission leaves; empty: all
  std::vector<float> re_, im_;             // [n_pulses][pad + stride + pad]
  std::vector<float> range_re_, range_im_;
};

}  // namespace obliq
