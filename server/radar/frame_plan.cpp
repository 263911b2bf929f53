#include "server/radar/frame_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "server/radar/beam/doppler_fault.h"
#include "server/radar/beam/sub_bins.h"
#include "server/radar/geometry/antenna_velocity.h"
#include "server/radar/narrow_bins.h"
#include "server/radar/sea_state.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

AntennaAxes axes_of(const RadarSettings& settings, const PoseSettings& pose) {
  if (settings.beam.stabilised) return {};
  return {pose.roll_deg * kDegree_rad, pose.pitch_deg * kDegree_rad,
          std::remainder(pose.bearing_deg - pose.heading_deg, 360.0) * kDegree_rad};
}

/// A velocity in the world's axes in those of the antenna's sector.
SectorVelocity in_sector(const glm::dvec3& v, const RadarSettings& settings, const Pose& pose,
                         const AntennaAxes& axes) {
  const Sector sector(settings, pose);
  const glm::dvec3 own = axes.own({v.x * sector.sin_bearing + v.z * sector.cos_bearing,
                                   v.x * sector.cos_bearing - v.z * sector.sin_bearing, v.y});
  return {own.x, own.y, own.z};
}

/// Of the sea's scatterers, in the world's axes.
glm::dvec3 sea_velocity_m_s(const RadarSettings& settings, const Pose& pose, double downwind_m_s) {
  const SinCos from = wind_bearing(settings, pose.north_rad);
  return {-downwind_m_s * from.sin, 0, -downwind_m_s * from.cos};
}

/// What moves by itself, where a mode shows it.
void place_moving(const Scene& scene, const RadarSettings& settings, const glm::dvec3& antenna_m_s,
                  const Pose& pose, EchoPlace& place) {
  if (settings.mode == RadarMode::map) return;
  const bool shows_wind = settings.mode == RadarMode::mti || settings.mode == RadarMode::pulses;
  const bool has_wind = settings.atmosphere.wind_m_s > 0 && shows_wind;
  const bool has_sea = sea_state(settings) > 0;
  place.all_windy = has_wind;
  for (std::size_t id = 0; id < scene.materials().size(); ++id) {
    const Material& material = scene.materials()[id];
    if (!material.used) continue;
    const bool is_sea = has_sea && material.model == ScatteringModel::sea && material.gamma > 0;
    const bool is_windy = has_wind && material.wind && !is_sea;
    if (is_sea) place.sea.materials.push_back(static_cast<int>(id));
    if (is_windy) place.windy.push_back(static_cast<int>(id));
    place.all_windy = place.all_windy && is_windy;
  }
  if (place.sea.materials.empty()) return;
  const SeaMotion sea(settings);
  double downwind_m_s = sea.downwind_m_s;
  if (settings.mode == RadarMode::sar) {
    const double across_m_s = place.velocity.least_across_m_s(settings.sector_deg * kDegree_rad);
    place.sea.smear = sea_smear(sea, across_m_s);
    // As fast as is shown.
    downwind_m_s = std::min(downwind_m_s, place.sea.smear.moved_rad * across_m_s);
  }
  const glm::dvec3 sea_m_s = sea_velocity_m_s(settings, pose, downwind_m_s);
  place.sea.velocity = in_sector(antenna_m_s - sea_m_s, settings, pose, place.axes);
  place.sea.beam_rad = azimuth_resolution_rad(settings);
}

EchoPlace place_of(const Scene& scene, const RadarSettings& settings, const Pose& pose) {
  EchoPlace place;
  place.axes = axes_of(settings, pose.settings);
  if (uses_doppler(settings)) {
    const glm::dvec3 antenna_m_s = antenna_velocity_m_s(scene.world(), pose);
    place.velocity = in_sector(antenna_m_s, settings, pose, place.axes);
    place_moving(scene, settings, antenna_m_s, pose, place);
  }
  SectorExtent extent;
  if (std::isnan(pose.ground_y_m)) extent = measure_sector(scene, Sector(settings, pose));
  const double above_m = pose.antenna.m.y - ground_y_m(pose, extent);
  if (std::isnan(above_m)) return place;
  const TileBounds& ground = scene.tiles();
  place.height_m = std::max(pose.antenna.m.y - ground.lowest_m(), ground.highest_m() - pose.antenna.m.y);
  place.above_ground_m = above_m;
  if (settings.frustum != FrustumKind::sweep) place.least_r_min_m = above_m;
  return place;
}

}  // namespace

FramePlan::FramePlan(const SettingsSnapshot& snapshot, const Pose& pose)
    : snapshot_(snapshot), pose_(pose), sector_(snapshot.settings, pose), bins_(bin_grid(snapshot.settings)) {
  snapshot_.settings.speckle = resolved_speckle(snapshot_.settings);
}

std::shared_ptr<FramePlan> FramePlan::again(const PoseSettings& pose) const {
  auto plan = std::make_shared<FramePlan>(*this);
  plan->pose_.settings = pose;
  plan->looks_at_ = looks_at_->again(pose);
  return plan;
}

std::optional<std::vector<FieldError>> known_beam_faults(const RadarSettings& settings,
                                                         const PoseSettings& pose) {
  std::vector<FieldError> errors;
  // An automatic tilt looks at the ground.
  if (!pose.tilt_auto) check_elevation(settings.beam, pose.tilt_deg, errors);
  if (!errors.empty() || !needs_echo_plan(settings)) return errors;
  return layout_faults(settings, axes_of(settings, pose));
}

std::vector<FieldError> beam_faults(std::shared_ptr<const Scene> scene, const RadarSettings& settings,
                                    const Pose& pose) {
  if (const auto known = known_beam_faults(settings, pose.settings)) return *known;
  const EchoPlace place = place_of(*scene, settings, pose);
  const EchoLayout layout = lay_out_echo(settings, AzimuthPattern(settings), place);
  auto fault = layout_fault(settings, layout, place);
  if (!fault) fault = too_few_rows(settings, layout, place);
  return fault ? std::vector<FieldError>{*fault} : std::vector<FieldError>{};
}

PlanResult plan_frame(std::shared_ptr<const Scene> scene, const SettingsPtr& snapshot, const Pose& pose) {
  std::vector<FieldError> errors = sampling_faults(snapshot->settings);
  if (errors.empty()) errors = flat_plate_faults(snapshot->settings, scene->materials());
  if (!errors.empty()) return {nullptr, std::move(errors)};
  std::shared_ptr<FramePlan> frame(new FramePlan(*snapshot, pose));
  const RadarSettings& settings = frame->settings();
  Pose turned = pose;
  if (needs_echo_plan(settings)) {
    std::optional<EchoPlan> sum = plan_echo(settings, place_of(*scene, settings, pose), errors);
    if (!sum) return {nullptr, std::move(errors)};
    if (!sum->ground)
      turned.bearing_world_rad +=
          sum->turn_bins * sum->sharp.sector_deg * std::numbers::pi / 180 / sum->sharp.azimuth_bins;
    frame->sum_ = std::make_shared<const EchoPlan>(*std::move(sum));
  }
  const EchoPlan* sum = frame->sum();
  const RadarSettings& sharp = sum != nullptr ? sum->looks_at() : settings;
  frame->narrow_bins_ = narrow_bins(sharp);
  ScenePlanResult looks_at =
      plan_scene(std::move(scene), narrow_frame(sharp), turned,
                 blurs(settings) || uses_doppler(settings) || frame->narrow_bins_ > 1,
                 sum != nullptr ? sum->widths.get() : nullptr, axes_of(settings, pose.settings));
  if (!looks_at.plan) return {nullptr, std::move(looks_at.errors)};
  frame->looks_at_ = std::move(looks_at.plan);
  return {std::move(frame), {}};
}

}  // namespace obliq
