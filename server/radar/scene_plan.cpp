#include "server/radar/scene_plan.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "server/radar/simd/lanes/exact_math.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

/// What the chosen frustum asks of scene and pose, beyond what validate() can know.
void check_frustum(const ScenePlan& plan, std::vector<FieldError>& errors) {
  const RadarSettings& settings = plan.settings();
  if (settings.frustum == FrustumKind::sweep) return;
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

/// The boresight's elevation about the antenna's own vertical: the pose's, or that of level ground in the
/// middle of the swath.
double tilt_rad(const RadarSettings& settings, const Pose& pose, const SectorExtent& extent,
                const WorldFrame& frame) {
  if (!pose.settings.tilt_auto) return pose.settings.tilt_deg * kPi / 180;
  const glm::dvec3& at = pose.antenna.m;
  const double middle_m = (settings.r_min_m + settings.r_max_m) / 2;
  const double ground = ground_y_m(pose, extent);
  const double height_m = std::isnan(ground) ? at.y - frame.datum_y_m(at.x, at.z) : at.y - ground;
  // How far the datum falls away below the antenna's horizon: the same in all directions.
  const double drop_m = frame.datum_y_m(at.x, at.z) -
                        (frame.datum_y_m(at.x + middle_m, at.z) + frame.datum_y_m(at.x - middle_m, at.z)) / 2;
  return -std::asin(std::clamp((height_m + drop_m) / middle_m, -1.0, 1.0));
}

std::shared_ptr<const AntennaGain> antenna_gain(const RadarSettings& settings, const Pose& pose,
                                                const SectorExtent& extent, const WorldFrame& frame,
                                                const BeamWidths* widths, const AntennaAxes& axes) {
  AntennaGain::View view;
  view.tilt_rad = tilt_rad(settings, pose, extent, frame);
  if (settings.beam.elevation != ElevationPattern::off || widths != nullptr) {
    const glm::dvec3& at = pose.antenna.m;
    constexpr double kStep_m = 1;
    view.lean_x =
        (frame.datum_y_m(at.x - kStep_m, at.z) - frame.datum_y_m(at.x + kStep_m, at.z)) / (2 * kStep_m);
    view.lean_z =
        (frame.datum_y_m(at.x, at.z - kStep_m) - frame.datum_y_m(at.x, at.z + kStep_m)) / (2 * kStep_m);
    if (!axes.is_level()) {
      view.rise = axes.up().z;
      const Sector sector(settings, pose);
      const glm::dvec3 up = sector.world_from_antenna(axes.up().y, 0, axes.up().x);
      view.lean_x += up.x / view.rise;
      view.lean_z += up.z / view.rise;
    }
    // The table covers only elevations at which surface exists.
    const double lean = std::hypot(view.lean_x, view.lean_z) + 1e-3;
    const double nearest_m = std::max(settings.r_min_m, 1.0);
    if (extent.any) {
      view.least_sine = std::max(-1.0, std::min((extent.bottom_y_m - at.y) / nearest_m,
                                                (extent.bottom_y_m - at.y) / settings.r_max_m)) -
                        lean;
      view.greatest_sine = std::min(1.0, std::max((extent.top_y_m - at.y) / nearest_m,
                                                  (extent.top_y_m - at.y) / settings.r_max_m)) +
                           lean;
    }
  }
  return std::make_shared<const AntennaGain>(settings, view, widths);
}

std::string degrees_text(double degrees) {
  char text[40];
  std::snprintf(text, sizeof text, "%.6g deg", degrees);
  return text;
}

}  // namespace

BinGrid bin_grid(const RadarSettings& settings) {
  BinGrid bins;
  bins.n_azimuth = settings.azimuth_bins;
  bins.n_range = settings.range_bins;
  bins.azimuth_start_rad = -settings.sector_deg * kPi / 180 / 2;
  bins.azimuth_width_rad = settings.azimuth_bin_rad();
  bins.r_min_m = settings.r_min_m;
  bins.r_max_m = settings.r_max_m;
  bins.range_spacing_m = settings.range_bin_m();
  return bins;
}

double ground_y_m(const Pose& pose, const SectorExtent& extent) {
  return std::isnan(pose.ground_y_m) && extent.any ? extent.bottom_y_m : pose.ground_y_m;
}

// A cosecant squared begins half a width below the nose, which must be below the horizon.
void check_elevation(const BeamSettings& beam, double tilt_deg, std::vector<FieldError>& errors) {
  if (beam.elevation == ElevationPattern::cosecant && tilt_deg >= beam.elevation_width_deg / 2)
    errors.push_back(
        {"antenna.tilt_deg", degrees_text(tilt_deg) + " with beam.elevation = \"cosecant\"",
         "below half of beam.elevation_width_deg, " + degrees_text(beam.elevation_width_deg / 2)});
}

ScenePlan::ScenePlan(std::shared_ptr<const Scene> scene, const RadarSettings& settings, const Pose& pose,
                     bool is_coherent_sum, const BeamWidths* widths, const AntennaAxes& axes)
    : scene_(std::move(scene)),
      settings_(settings),
      pose_(pose),
      sector_(settings, pose),
      extent_(measure_sector(*scene_, sector_)),
      box_(pose.antenna.m.y - extent_.bottom_y_m, extent_.top_y_m - extent_.bottom_y_m, sector_.r_min_m,
           sector_.r_max_m, sector_.width_rad),
      bins_(bin_grid(settings)),
      wavelength_m_(wavelength_at(settings.frequency_ghz)),
      buildings_(std::make_shared<const AzimuthBuildings>(*scene_, sector_, bins_, building_reach_m(),
                                                          settings.frustum != FrustumKind::sweep)),
      seen_(std::make_shared<SeenBuildings>(scene_->world().buildings.list.size())),
      antenna_gain_(obliq::antenna_gain(settings, pose_, extent_, scene_->world().frame, widths, axes)),
      is_coherent_sum_(is_coherent_sum) {}

std::shared_ptr<ScenePlan> ScenePlan::again(const PoseSettings& pose) const {
  std::shared_ptr<ScenePlan> plan(new ScenePlan(*this));
  plan->pose_.settings = pose;
  plan->seen_ = std::make_shared<SeenBuildings>(scene_->world().buildings.list.size());
  return plan;
}

WedgeEdges ScenePlan::wedge_edges(int first_azimuth) const {
  WedgeEdges edges;
  for (int k = 0; k < kWedgeAzimuthBins; ++k) {
    const SinCos bearing = sincos_turns(bearing_rad(first_azimuth + k) / (2 * kPi));
    edges.sin[k] = bearing.sin;
    edges.cos[k] = bearing.cos;
  }
  return edges;
}

double ScenePlan::building_reach_m() const { return sector_.r_max_m + 2 * scene_->world().grid.cell_m; }

bool needs_tracer(const Scene& scene, FrustumKind frustum) {
  if (frustum == FrustumKind::sweep) return false;
  return scene.rays() == RayMethod::embree || !scene.world().buildings.list.empty();
}

ScenePlanResult plan_scene(std::shared_ptr<const Scene> scene, const RadarSettings& settings,
                           const Pose& pose, bool is_coherent_sum, const BeamWidths* widths,
                           const AntennaAxes& axes) {
  ScenePlanResult result;
  auto plan = std::make_shared<ScenePlan>(std::move(scene), settings, pose, is_coherent_sum, widths, axes);
  check_frustum(*plan, result.errors);
  check_elevation(settings.beam, plan->antenna_gain().tilt_rad() * 180 / kPi, result.errors);
  if (!result.errors.empty()) return result;
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
      case FrustumKind::polar:  // refused by now
      case FrustumKind::sweep:
        break;
    }
  }
  result.plan = std::move(plan);
  return result;
}

}  // namespace obliq
