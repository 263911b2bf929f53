#pragma once
// Targets in small scenes, and what they add to frames.
#include <cmath>
#include <complex>
#include <vector>

#include "server/radar/render.h"
#include "server/radar/targets/target_echoes.h"
#include "server/radar/targets/target_place.h"
#include "tests/support/made_worlds.h"
#include "tests/support/scenes.h"

namespace obliq::test {

constexpr double kAntenna_m = 1000;

inline double db(double ratio) { return 10 * std::log10(ratio); }

inline World level_world() {
  return made_world(13000, 100, [](double, double) { return 0.0; });
}

/// 1 to 11 km, 90 degrees.
inline RadarSettings sharp_settings_of_test() {
  RadarSettings s = radar_settings(FrustumKind::sweep, {1000, 11000, 90}, {256, 512}, {256, 1});
  s.power_w = 1000;
  s.gain_db = 30;
  s.speckle = SpeckleKind::ground;
  return s;
}

inline RadarSettings beam_settings() {
  RadarSettings s = sharp_settings_of_test();
  s.beam.pattern = BeamPattern::gaussian;
  s.beam.width_deg = 3;
  s.pulse.kind = PulseKind::compressed;
  return s;
}

struct Bin {
  int azimuth = 0, range = 0;
  // Of its middle.
  double azimuth_rad = 0, range_m = 0;
};

inline Bin bin_near(const RadarSettings& s, double azimuth_rad, double range_m) {
  Bin bin;
  bin.azimuth = static_cast<int>(azimuth_rad / s.azimuth_bin_rad() + s.azimuth_bins / 2.0);
  bin.range = static_cast<int>((range_m - s.r_min_m) / s.range_bin_m());
  bin.azimuth_rad = (bin.azimuth + 0.5 - s.azimuth_bins / 2.0) * s.azimuth_bin_rad();
  bin.range_m = s.r_min_m + (bin.range + 0.5) * s.range_bin_m();
  return bin;
}

/// One frame less another.
struct Difference {
  Frame with, without;
  std::size_t index(const Bin& bin) const {
    return static_cast<std::size_t>(bin.azimuth) * static_cast<std::size_t>(with.bins.n_range) +
           static_cast<std::size_t>(bin.range);
  }
  double power_w(const Bin& bin) const {
    return with.bins.power_w[index(bin)] - without.bins.power_w[index(bin)];
  }
  std::complex<double> voltage(const Bin& bin) const {
    return std::complex<double>(with.bins.iq[index(bin)]) - std::complex<double>(without.bins.iq[index(bin)]);
  }
};

/// A world with an antenna over its origin, which looks north.
class TargetScene {
 public:
  explicit TargetScene(World world, double antenna_m = kAntenna_m,
                       std::vector<Material> materials = two_materials())
      : scene_(make_scene(std::move(world), std::move(materials))),
        pose_(pose_at(scene_->world(), {0, antenna_m + scene_->world().grid.height_at_m(0, 0), 0}, 0)) {}

  const World& world() const { return scene_->world(); }
  const Scene& scene() const { return *scene_; }
  const std::shared_ptr<const Scene>& shared() const { return scene_; }
  const Pose& pose() const { return pose_; }
  Pose& pose() { return pose_; }

  /// On the ground at a world place, its foot so far above.
  Target at(double x_m, double z_m, double over_ground_m) const {
    const Geodetic place = world().frame.geodetic_from_world({{x_m, 0, z_m}});
    Target target;
    target.id = 1;
    target.latitude_deg = place.latitude_rad / kDegree_rad;
    target.longitude_deg = place.longitude_rad / kDegree_rad;
    target.height_m = over_ground_m;
    return target;
  }
  /// On level ground, at an azimuth and a slant range.
  Target at_range(double azimuth_rad, double range_m, double over_ground_m) const {
    const double h = pose_.antenna.m.y - over_ground_m;
    const double d = std::sqrt(range_m * range_m - h * h);
    return at(d * std::sin(azimuth_rad), d * std::cos(azimuth_rad), over_ground_m);
  }

  Frame render(const RadarSettings& s, const std::vector<Target>& targets, int threads = 0,
               std::int64_t sim_time_ns = 0) const {
    const TargetSet set{1, targets};
    RenderOptions options;
    options.threads = threads;
    options.targets = &set;
    Pose pose = pose_;
    pose.settings.sim_time_ns = sim_time_ns;
    return obliq::render(scene_, snapshot(s), pose, {0, s.azimuth_bins}, options);
  }
  Frame part(const RadarSettings& s, const TargetSet& set, AzimuthRange azimuths) const {
    RenderOptions options;
    options.targets = &set;
    return obliq::render(scene_, snapshot(s), pose_, azimuths, options);
  }
  Frame bare(const RadarSettings& s) const {
    return obliq::render(scene_, snapshot(s), pose_, {0, s.azimuth_bins});
  }
  Difference difference(const RadarSettings& s, const std::vector<Target>& targets) const {
    return {render(s, targets), bare(s)};
  }

  /// Of the target's scatterers together, in the middle of beam and pulse.
  double echo_power(const RadarSettings& s, const Target& target, std::uint64_t frame) const {
    double sum = 0;
    for (const TargetEcho& echo : echoes(s, target, frame)) sum += echo.power_w;
    return sum;
  }
  std::complex<double> echo_voltage(const RadarSettings& s, const Target& target, std::uint64_t frame) const {
    std::complex<double> sum = 0;
    for (const TargetEcho& echo : echoes(s, target, frame)) sum += echo.voltage;
    return sum;
  }

 private:
  std::vector<TargetEcho> echoes(const RadarSettings& s, const Target& target, std::uint64_t frame) const {
    const PlanResult planned = plan_frame(scene_, snapshot(s), pose_);
    TargetLook look;
    look.frame = frame;
    return TargetEchoes(*planned.plan, air_view(planned.plan->looks_at()), {1, {target}}, {0, s.azimuth_bins},
                        look)
        .echoes();
  }

  std::shared_ptr<const Scene> scene_;
  Pose pose_;
};

/// v at psi degrees left of the sector's middle, which looks north.
inline void fly(TargetScene& scene, double v_m_s, double psi_deg, double up_m_s = 0) {
  PoseSettings& at = scene.pose().settings;
  at.velocity_north_m_s = v_m_s * std::cos(psi_deg * kDegree_rad);
  at.velocity_east_m_s = -v_m_s * std::sin(psi_deg * kDegree_rad);
  at.velocity_up_m_s = up_m_s;
}

}  // namespace obliq::test
