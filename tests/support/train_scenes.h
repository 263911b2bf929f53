#pragma once
// Trains of pulses in small scenes.
#include <complex>
#include <cstring>
#include <vector>

#include "server/radar/pulses/render_train.h"
#include "tests/support/doppler_scenes.h"
#include "tests/support/target_scenes.h"

namespace obliq::test {

inline RadarSettings train_settings() {
  RadarSettings s = doppler_radar(RadarMode::pulses, 105, 21);
  s.power_w = 1000;
  s.gain_db = 30;
  return s;
}

struct TrainChoice {
  std::vector<Target> targets{};
  double rate_deg_s = 0;
  AzimuthRange azimuths{0, 0};  ///< count 0: all
  std::uint64_t draw = 0;
  int threads = 0;
  SharpStore* sharp = nullptr;
  const Receiver* receiver = nullptr;
};

inline PulseTrain train_of(const TargetScene& scene, const RadarSettings& s, const TrainChoice& choice = {}) {
  const PlanResult planned = plan_frame(scene.shared(), snapshot(s), scene.pose());
  EXPECT_TRUE(planned.plan != nullptr) << (planned.errors.empty() ? "" : planned.errors.front().text());
  const TargetSet set{1, choice.targets};
  RenderOptions options;
  options.draw = choice.draw;
  options.threads = choice.threads;
  options.targets = &set;
  options.sharp = choice.sharp;
  options.receiver = choice.receiver;
  const AzimuthRange all{0, s.azimuth_bins};
  const TrainLook look{choice.azimuths.count == 0 ? all : choice.azimuths, choice.rate_deg_s};
  return render_train(scene.shared(), *planned.plan, look, options)->train;
}

inline std::complex<double> sample(const PulseTrain& train, int pulse, int gate) {
  return std::complex<double>(
      train.iq[static_cast<std::size_t>(pulse) * static_cast<std::size_t>(train.n_range) +
               static_cast<std::size_t>(gate)]);
}

inline bool same_train(const PulseTrain& a, const PulseTrain& b) {
  return a.iq.size() == b.iq.size() &&
         std::memcmp(a.iq.data(), b.iq.data(), a.iq.size() * sizeof a.iq[0]) == 0;
}

}  // namespace obliq::test
