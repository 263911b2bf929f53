#include "server/radar/pulses/render_train.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "server/radar/beam/point_response.h"
#include "server/radar/pulses/ground_pulses.h"
#include "server/radar/pulses/target_pulses.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/visibility/coverage.h"
#include "server/radar/wedge_sums.h"
#include "terrain/base/asking.h"
#include "terrain/base/errors.h"
#include "terrain/base/hash.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr int kGateWork = 4;
/// Roofs stand so high over the highest ground, and ground so far over the posts that are read.
constexpr double kRoofs_m = 1000;
/// As radar.r_max_m's limit.
constexpr double kFarthestTarget_m = 500e3;

/// The swath in which a trip's echoes are.
SettingsPtr trip_settings(const FramePlan& plan, double shift_m) {
  auto trip = std::make_shared<SettingsSnapshot>(SettingsSnapshot{plan.settings(), plan.settings_version()});
  trip->settings.r_min_m += shift_m;
  trip->settings.r_max_m += shift_m;
  return trip;
}

/// One rendering of a train.
class TrainWork {
 public:
  TrainWork(std::shared_ptr<const Scene> scene, const FramePlan& plan, const TrainLook& look,
            const RenderOptions& options)
      : scene_(std::move(scene)), plan_(plan), options_(options), times_(plan.settings()) {
    const RadarSettings& s = plan.settings();
    const double bin_rad = plan.sum()->output_rad;
    boresight_.middle_rad =
        plan.sum()->start_rad + (look.azimuths.first + look.azimuths.count / 2.0) * bin_rad;
    boresight_.rate_rad_s = look.rate_deg_s * kDegree_rad;
    train_.azimuths = look.azimuths;
    train_.n_pulses = times_.n();
    train_.n_range = s.range_bins;
    for (const double interval_s : times_.intervals_s()) train_.period_ns.push_back(interval_s * 1e9);
    train_.boresight_start_deg =
        plan.pose().settings.bearing_deg + boresight_.at_rad(times_.at_s(0)) / kDegree_rad;
    train_.boresight_rate_deg_s = look.rate_deg_s;
    train_.iq.resize(static_cast<std::size_t>(train_.n_pulses) * static_cast<std::size_t>(train_.n_range));
    // Each train is another draw, wherever its rows come from.
    key_ = mix64(mix64(options.draw ^ static_cast<std::uint64_t>(s.speckle_seed)) +
                 static_cast<std::uint64_t>(look.azimuths.first) + 1);
  }

  std::optional<RenderedTrain> run() {
    reach_m_ = farthest_seen_m(*scene_, plan_.pose());
    // Aircraft are seen beyond the ground.
    const bool has_targets = options_.targets != nullptr && !options_.targets->targets.empty();
    const double trips_reach_m = has_targets ? kFarthestTarget_m : reach_m_;
    for (const PulseTrip& trip : pulse_trips(times_, plan_.settings().r_min_m, trips_reach_m))
      if (!add(trip)) return std::nullopt;
    if (plan_.sum()->range_normalisation) normalise();
    if (options_.receiver != nullptr) options_.receiver->receive(train_);
    for (int azimuth = train_.azimuths.first; azimuth < train_.azimuths.first + train_.azimuths.count;
         ++azimuth) {
      const GroundArea area = ground_area(plan_, azimuth);
      stats_.sector_area_m2 += area.sector_m2;
      stats_.covered_area_m2 += area.covered_m2;
    }
    return RenderedTrain{std::move(train_), stats_};
  }

 private:
  bool add(const PulseTrip& trip) {
    if (trip.shift_m == 0) return add(trip, plan_, options_);
    const PlanResult later = plan_frame(scene_, trip_settings(plan_, trip.shift_m), plan_.pose());
    if (!later.plan) throw InputError(later.errors.front().text());
    RenderOptions options = options_;
    options.sharp = nullptr;  // that holds the first trip's
    return add(trip, *later.plan, options);
  }

  bool add(const PulseTrip& trip, const FramePlan& plan, const RenderOptions& options) {
    GroundPulses ground(plan, times_, boresight_);
    if (plan.settings().r_min_m < reach_m_) {
      const auto rows = look_at_rows(plan, ground.rows(), ground.azimuths(), options);
      if (!rows) return false;
      const std::uint64_t key =
          trip.shift_m == 0 ? key_ : mix64(key_ ^ std::bit_cast<std::uint64_t>(trip.shift_m));
      ground.add(*rows, trip, key, train_);
      stats_.add(rows->stats);
    }
    if (options.targets == nullptr) return true;
    TargetLook look = target_look(options);
    look.moves = true;
    const TargetEchoes targets(plan, air_view(plan.looks_at()), *options.targets, ground.azimuths(), look);
    add_target_pulses(plan, targets, times_, boresight_, trip, train_);
    return true;
  }

  void normalise() {
    for (int m = 0; m < train_.n_range; ++m) {
      const double range_m = plan_.bins().r_min_m + (m + 0.5) * plan_.bins().range_spacing_m;
      for (int pulse = 0; pulse < train_.n_pulses; ++pulse)
        train_.iq[static_cast<std::size_t>(pulse) * static_cast<std::size_t>(train_.n_range) +
                  static_cast<std::size_t>(m)] *= static_cast<float>(range_m * range_m);
      ask(std::int64_t{kGateWork} * train_.n_pulses);
    }
  }

  const std::shared_ptr<const Scene> scene_;
  const FramePlan& plan_;
  const RenderOptions& options_;
  const PulseTimes times_;
  Boresight boresight_;
  double reach_m_ = 0;  ///< of ground that is seen
  std::uint64_t key_ = 0;
  PulseTrain train_;
  FrameStats stats_;
};

}  // namespace

double farthest_seen_m(const Scene& scene, const Pose& pose) {
  const World& world = scene.world();
  const glm::dvec3& at_m = pose.antenna.m;
  const double x_m = std::max(std::abs(world.grid.x0_m - at_m.x), std::abs(world.grid.x1_m() - at_m.x));
  const double z_m = std::max(std::abs(world.grid.z0_m - at_m.z), std::abs(world.grid.z1_m() - at_m.z));
  const double y_m =
      std::max(std::abs(at_m.y - scene.tiles().lowest_m()), std::abs(scene.highest_m() - at_m.y));
  const double loaded_m = std::sqrt(x_m * x_m + z_m * z_m + y_m * y_m);
  const double radius_m = world.frame.radius_factor() * kMeanEarthRadius_m;
  const double antenna_m = world.frame.geodetic_from_world(pose.antenna).height_m;
  const auto horizon_m = [&](double height_m) { return std::sqrt(2 * radius_m * std::max(0.0, height_m)); };
  const double seen_m = horizon_m(antenna_m - world.report.lowest_m) +
                        horizon_m(world.report.highest_m + kRoofs_m - world.report.lowest_m);
  return std::isfinite(seen_m) ? std::min(loaded_m, seen_m) : loaded_m;
}

TrainLook train_of_frame(const RadarSettings& s) {
  return {{0, s.azimuth_bins}, s.scan_mode == ScanMode::frame ? 0 : s.scan_rate_deg_s};
}

std::optional<RenderedTrain> render_train(const std::shared_ptr<const Scene>& scene, const FramePlan& plan,
                                          const TrainLook& look, const RenderOptions& options) {
  return TrainWork(scene, plan, look, options).run();
}

}  // namespace obliq
