#include "server/radar/frame_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kSpeedOfLight_m_s = 299792458.0;  // exact, SI

BinGrid bin_grid(const RadarSettings& settings) {
  BinGrid bins;
  bins.n_azimuth = settings.azimuth_bins;
  bins.n_range = settings.range_bins;
  const double sector_rad = settings.sector_deg * kPi / 180;
  bins.azimuth_start_rad = -sector_rad / 2;
  bins.azimuth_width_rad = sector_rad / settings.azimuth_bins;
  bins.r_min_m = settings.r_min_m;
  bins.r_max_m = settings.r_max_m;
  bins.range_spacing_m = (settings.r_max_m - settings.r_min_m) / settings.range_bins;
  return bins;
}

/// What the chosen frustum asks of scene and pose, beyond what validate() can know.
void check_frustum(const FramePlan& plan, std::vector<FieldError>& errors) {
  const RadarSettings& settings = plan.settings();
  if (settings.frustum == FrustumKind::polar || settings.frustum == FrustumKind::sweep) return;
  const Pose& pose = plan.pose();
  if (std::isnan(pose.ground_y_m) && !plan.extent().any) return;
  const double ground_y_m = std::isnan(pose.ground_y_m) ? plan.extent().bottom_y_m : pose.ground_y_m;
  const double above_ground_m = pose.antenna.m.y - ground_y_m;
  // Equality is legal; the slack covers float32 heights.
  if (settings.r_min_m < above_ground_m - 1e-6 * settings.r_min_m)
    errors.push_back(
        {"radar.r_min_m", metres_text(settings.r_min_m),
         "at least the antenna's height above the ground, " + metres_text(above_ground_m) +
             ", with the symmetric and oblique frusta; any with frustum.quality = \"standard\", the sweep"});
  if (settings.frustum == FrustumKind::oblique && plan.extent().any && plan.box().kappa_m <= 0)
    errors.push_back(
        {"frustum.kind",
         "\"oblique\" with the antenna " + metres_text(-plan.box().kappa_m) +
             " below the highest ground or roof in the sector",
         "an antenna above it, or frustum.quality = \"standard\", the sweep, which sees from anywhere"});
}

}  // namespace

FramePlan::FramePlan(std::shared_ptr<const Scene> scene, const SettingsSnapshot& snapshot, const Pose& pose)
    : scene_(std::move(scene)),
      snapshot_(snapshot),
      pose_(pose),
      sector_(snapshot_.settings, pose),
      extent_(measure_sector(*scene_, sector_)),
      box_(pose.antenna.m.y - extent_.bottom_y_m, extent_.top_y_m - extent_.bottom_y_m, sector_.r_min_m,
           sector_.r_max_m, sector_.width_rad),
      bins_(bin_grid(snapshot_.settings)),
      wavelength_m_(kSpeedOfLight_m_s / (snapshot_.settings.frequency_ghz * 1e9)),
      buildings_(std::make_shared<const AzimuthBuildings>(*scene_, sector_, bins_, building_reach_m(),
                                                          snapshot_.settings.frustum != FrustumKind::sweep)),
      seen_(std::make_shared<SeenBuildings>(scene_->world().buildings.list.size())) {}

std::shared_ptr<FramePlan> FramePlan::again(const PoseSettings& pose) const {
  std::shared_ptr<FramePlan> plan(new FramePlan(*this));
  plan->pose_.settings = pose;
  plan->seen_ = std::make_shared<SeenBuildings>(scene_->world().buildings.list.size());
  return plan;
}

double FramePlan::building_reach_m() const { return sector_.r_max_m + 2 * scene_->world().grid.cell_m; }

bool needs_tracer(const Scene& scene, FrustumKind frustum) {
  if (frustum == FrustumKind::sweep) return false;
  if (scene.rays() == RayMethod::embree) return true;
  return frustum != FrustumKind::polar && !scene.world().buildings.list.empty();
}

int sweep_columns_per_bin(const RadarSettings& settings) {
  return (settings.pixel_columns + settings.azimuth_bins - 1) / settings.azimuth_bins;
}

PlanResult plan_frame(std::shared_ptr<const Scene> scene, const SettingsPtr& snapshot, const Pose& pose) {
  PlanResult result;
  auto plan = std::make_shared<FramePlan>(std::move(scene), *snapshot, pose);
  check_frustum(*plan, result.errors);
  if (!result.errors.empty()) return result;
  const RadarSettings& settings = plan->settings();
  if (plan->extent_.any) {
    switch (settings.frustum) {
      case FrustumKind::oblique:
        plan->camera_ = oblique_frustum(plan->box_, settings.pixel_columns, settings.pixel_rows);
        break;
      case FrustumKind::symmetric:
        try {
          plan->camera_ = symmetric_frustum(plan->box_, plan->sector_.width_rad, settings.pixel_columns,
                                            settings.pixel_rows);
        } catch (const InputError& error) {
          result.errors.push_back({"frustum.kind", "\"symmetric\"", error.what()});
          return result;
        }
        break;
      case FrustumKind::polar:
        plan->polar_ = polar_rows(plan->sector_, plan->extent_, plan->box_, plan->scene_->world().frame,
                                  settings.pixel_rows);
        if (plan->scene_->rays() == RayMethod::march)
          plan->swept_rays_ =
              std::make_shared<const ProfileRays>(*plan->scene_, plan->sector_.antenna_m, plan->polar_.ray,
                                                  std::numeric_limits<double>::infinity());
        break;
      case FrustumKind::sweep:
        break;
    }
  }
  result.plan = std::move(plan);
  return result;
}

}  // namespace obliq
