#include "server/output/describe_frame.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/output/describe_load.h"
#include "server/radar/frame_plan.h"
#include "terrain/constants.h"

namespace obliq {
namespace {

/// Above this height the 4/3 rule is not to be trusted (design section 1: 24 m of height at 100 km from 3
/// km).
constexpr double kLowAltitude_m = 3000;
/// Beyond this distance from the scene origin the world's vertical leans noticeably (design section 1).
constexpr double kFarFromOrigin_m = 20000;

const char* model_name(ScatteringModel model) {
  switch (model) {
    case ScatteringModel::constant_gamma:
      return "constant_gamma";
    case ScatteringModel::geometric_optics:
      return "geometric_optics";
    case ScatteringModel::flat_plate:
      return "flat_plate";
  }
  return "";
}

template <typename... Values>
std::string sentence(const char* format, Values... values) {
  char text[256];
  std::snprintf(text, sizeof text, format, values...);
  return text;
}

/// The lift y -= (1 - 1/k) y0(x, z) tilts by (1 - 1/k) rho / R at distance rho from the origin: y changes by
/// that share of the horizontal distance d, and a slant range by (dy / r) of it, dy d / r <= |dy|.
double shear_bound_m(const FramePlan& plan, double off_origin_m) {
  const SectorExtent& extent = plan.extent();
  const double antenna_y_m = plan.pose().antenna.m.y;
  const double tilt =
      std::abs(1 - 1 / plan.scene().world().frame.radius_factor()) * off_origin_m / kMeanEarthRadius_m;
  return tilt * std::max(std::abs(antenna_y_m - extent.bottom_y_m), std::abs(antenna_y_m - extent.top_y_m));
}

void add_warnings(const FramePlan& plan, double off_origin_m, wire::FrameDescriptor& descriptor) {
  const WorldFrame& frame = plan.scene().world().frame;
  const double above_m = frame.geodetic_from_world(plan.pose().antenna).height_m;
  if (frame.radius_factor() != 1 && std::isfinite(frame.radius_factor()) && above_m > kLowAltitude_m)
    descriptor.add_warnings(
        sentence("antenna at %.0f m: an effective-earth factor of %.4g is a rule for below %.0f m", above_m,
                 frame.radius_factor(), kLowAltitude_m));
  if (off_origin_m > kFarFromOrigin_m && std::isfinite(frame.radius_factor()))
    descriptor.add_warnings(
        sentence("antenna %.1f km from the scene origin: azimuths are off by up to %.3g degrees, slant "
                 "ranges by %.3g m",
                 off_origin_m / 1000, descriptor.azimuth_error_bound_rad() / kDegree_rad,
                 shear_bound_m(plan, off_origin_m)));
  if (!plan.extent().any) descriptor.add_warnings("no known ground in the sector");
}

/// tan|elevation| of the steepest line of sight into the sector's box, down or up; at most 70.7.
double steepest_tangent(const FramePlan& plan) {
  constexpr double kGreatestSine = 0.9999;
  const double below_m = plan.box().antenna_above_bottom_m;
  const double r_min_m = plan.bins().r_min_m;
  const double down = below_m <= 0                        ? 0
                      : below_m < kGreatestSine * r_min_m ? below_m / r_min_m
                                                          : kGreatestSine;
  const double up = std::sin(plan.extent().highest_elevation_rad);
  const double sine = std::clamp(std::max(down, up), 0.0, kGreatestSine);
  return sine / std::sqrt(1 - sine * sine);
}

}  // namespace

void describe_frame(const FramePlan& plan, const std::string& radar, const std::string& scene_name,
                    wire::FrameDescriptor& descriptor) {
  const World& world = plan.scene().world();
  const BinGrid& bins = plan.bins();
  const Pose& pose = plan.pose();
  descriptor.set_radar(radar);
  descriptor.set_scene_name(scene_name);
  descriptor.set_settings_version(plan.settings_version());
  write_message(plan.settings(), *descriptor.mutable_settings());
  write_message(pose.settings, *descriptor.mutable_pose());
  descriptor.set_origin_latitude_deg(world.frame.origin_latitude_rad() / kDegree_rad);
  descriptor.set_origin_longitude_deg(world.frame.origin_longitude_rad() / kDegree_rad);
  descriptor.set_radius_factor(world.frame.radius_factor());
  descriptor.set_antenna_x_m(pose.antenna.m.x);
  descriptor.set_antenna_y_m(pose.antenna.m.y);
  descriptor.set_antenna_z_m(pose.antenna.m.z);
  descriptor.set_north_rad(pose.north_rad);
  descriptor.set_wavelength_m(plan.wavelength_m());
  descriptor.set_azimuth_start_deg(pose.settings.bearing_deg - plan.settings().sector_deg / 2);
  descriptor.set_azimuth_width_deg(plan.settings().sector_deg / bins.n_azimuth);
  descriptor.set_range_start_m(bins.r_min_m);
  descriptor.set_range_spacing_m(bins.range_spacing_m);
  descriptor.set_phase_sign(-1);
  descriptor.set_unit("sqrt(W)");
  descriptor.set_azimuth_reference("clockwise from the antenna's true north");
  descriptor.set_bottom_y_m(plan.extent().bottom_y_m);
  descriptor.set_top_y_m(plan.extent().top_y_m);
  descriptor.set_map_reference_height_m(plan.extent().median_height_m);
  // At most rho / (k R) tan|elevation|, rho the antenna's distance from the scene origin (design section 1).
  const double rho_m = std::hypot(pose.antenna.m.x, pose.antenna.m.z);
  descriptor.set_azimuth_error_bound_rad(rho_m / (world.frame.radius_factor() * kMeanEarthRadius_m) *
                                         steepest_tangent(plan));
  for (const Material& material : plan.scene().materials()) {
    wire::Material& row = *descriptor.add_materials();
    row.set_name(material.name);
    row.set_model(model_name(material.model));
    row.set_gamma(material.gamma);
    row.set_reflectivity(material.reflectivity);
    row.set_rms_slope(material.rms_slope);
    row.set_plate_tau(material.plate_tau);
    row.set_plate_exponent(material.plate_exponent);
  }
  descriptor.set_cell_m(world.grid.cell_m);
  const SourceError& error = world.report.source_error;
  wire::SourceError& row = *descriptor.mutable_source_error();
  row.set_posts(error.posts);
  row.set_median_m(error.median_m);
  row.set_p95_m(error.p95_m);
  row.set_rms_m(error.rms_m);
  row.set_greatest_m(error.greatest_m);
  descriptor.set_wedge_azimuth_bins(kWedgeAzimuthBins);
  descriptor.set_buildings_in_scene(static_cast<std::uint32_t>(world.buildings.list.size()));
  describe_load(world.report, descriptor);
  add_warnings(plan, rho_m, descriptor);
}

void summarise_frame(const FramePlan& plan, const FrameStats& stats, wire::FrameSummary& summary) {
  summary.set_rays(stats.rays);
  summary.set_hits(stats.hits);
  summary.set_samples(stats.samples);
  summary.set_repaired(stats.repaired);
  summary.set_rejected(stats.rejected);
  summary.set_coverage(stats.coverage());
  summary.set_buildings_seen(plan.seen().count());
}

std::vector<std::string> frame_warnings(const wire::FrameDescriptor& descriptor,
                                        const wire::FrameSummary& summary) {
  std::vector<std::string> warnings(descriptor.warnings().begin(), descriptor.warnings().end());
  if (summary.coverage() < 1) {
    const double percent = 100 * (1 - summary.coverage());
    warnings.push_back(sentence(percent < 10 ? "%.2g %% of the sector has no known ground"
                                             : "%.0f %% of the sector has no known ground",
                                percent));
  }
  return warnings;
}

}  // namespace obliq
