#include "server/output/describe_frame.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "proto/obliq.pb.h"
#include "server/accuracy/thresholds.h"
#include "server/control/settings_message.h"
#include "server/radar/doppler/doppler_warnings.h"
#include "server/radar/echo/sea_warnings.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/unsampled.h"
#include "terrain/base/units.h"
#include "terrain/cache/cache_key.h"

namespace obliq {

namespace {

/// Above this height over the ground an effective-earth factor is not to be trusted without a look.
constexpr double kLowAltitude_m = 3000;
/// Refractivity of the standard atmosphere, N0 exp(-h / H) (ITU-R P.453-14, eq. 10).
constexpr double kRefractivity = 315e-6;
constexpr double kScaleHeight_m = 7350;
/// What is worth a word.
constexpr double kNoticeable_db = 0.1;
/// Beyond this distance from the scene origin the world's vertical leans noticeably (PAPER.md, definitions).
constexpr double kFarFromOrigin_m = 20000;

const char* model_name(ScatteringModel model) {
  switch (model) {
    case ScatteringModel::constant_gamma:
      return "constant_gamma";
    case ScatteringModel::geometric_optics:
      return "geometric_optics";
    case ScatteringModel::flat_plate:
      return "flat_plate";
    case ScatteringModel::sea:
      return "sea";
  }
  return "";
}

/// The lift y -= (1 - 1/k) y0(x, z) tilts by (1 - 1/k) rho / R at distance rho from the origin: y changes by
/// that share of the horizontal distance d, and a slant range by (dy / r) of it, dy d / r <= |dy|.
double shear_bound_m(const FramePlan& plan, double off_origin_m) {
  const SectorExtent& extent = plan.looks_at().extent();
  const double antenna_y_m = plan.pose().antenna.m.y;
  const double tilt =
      std::abs(1 - 1 / plan.scene().world().frame.radius_factor()) * off_origin_m / kMeanEarthRadius_m;
  return tilt * std::max(std::abs(antenna_y_m - extent.bottom_y_m), std::abs(antenna_y_m - extent.top_y_m));
}

/// 1/k of the standard atmosphere's mean gradient between two heights above the datum.
double standard_curvature(double low_m, double high_m) {
  const double lost =
      kRefractivity * (std::exp(-low_m / kScaleHeight_m) - std::exp(-high_m / kScaleHeight_m));
  return 1 - kMeanEarthRadius_m * lost / (high_m - low_m);
}

/// Where an effective-earth factor may be wrong for so high an antenna: what the standard atmosphere's own
/// would change at the far edge, or short of the horizon. Empty where that is nothing to speak of.
std::string refraction_warning(const FramePlan& plan) {
  const WorldFrame& frame = plan.scene().world().frame;
  const double k = frame.radius_factor();
  if (k == 1 || !std::isfinite(k) || !plan.looks_at().extent().any) return {};
  const double antenna_m = frame.geodetic_from_world(plan.pose().antenna).height_m;
  const double ground_y_m = plan.pose().ground_y_m;
  const double above_m = std::isnan(ground_y_m) ? antenna_m - plan.looks_at().extent().median_height_m
                                                : plan.pose().antenna.m.y - ground_y_m;
  if (!(above_m > kLowAltitude_m)) return {};
  const double standard = standard_curvature(antenna_m - above_m, antenna_m);
  const double range_m = std::min(plan.bins().r_max_m, 0.9 * horizon_m(above_m, std::max(1 / k, standard)));
  if (!(range_m > above_m)) return {};
  const double ground_range_m = std::sqrt((range_m - above_m) * (range_m + above_m));
  const double moved_m = std::abs(ground_slant_range_m(ground_range_m, above_m, standard) -
                                  ground_slant_range_m(ground_range_m, above_m, 1 / k));
  const double change_db = std::abs(10 * std::log10(curved_ground_power_ratio(range_m, above_m, standard) /
                                                    curved_ground_power_ratio(range_m, above_m, 1 / k)));
  if (moved_m <= plan.bins().range_spacing_m / 2 && change_db <= kNoticeable_db) return {};
  return fmt::format(
      "antenna {:.0f} m above the ground: earth.radius_factor = {:.4g} is a rule for below {:.0f} m; by the "
      "standard atmosphere it would be {:.4g} here, which moves level ground at {:.0f} km by {:.2g} m and "
      "changes its power by {:.2g} dB",
      above_m, k, kLowAltitude_m, 1 / standard, range_m / 1000, moved_m, change_db);
}

/// Level ground more than 87 degrees below the antenna, where a beam is wider than its weights over azimuth
/// are made for (cosine_steps). Empty where no bin holds any.
std::string steep_beam_warning(const FramePlan& plan) {
  if (plan.settings().beam.pattern == BeamPattern::off || std::isnan(plan.pose().ground_y_m)) return {};
  const double above_m = plan.pose().antenna.m.y - plan.pose().ground_y_m;
  const BinGrid& bins = plan.bins();
  const double to_m = std::min(above_m / std::sin(87 * kDegree_rad), bins.r_max_m);
  if (!(above_m > 0 && to_m > bins.r_min_m && above_m < bins.r_max_m)) return {};
  const double from_m = std::max(above_m, bins.r_min_m);
  const int first = bins.range_bin(from_m);
  const int last =
      std::max(first, static_cast<int>(std::ceil((to_m - bins.r_min_m) / bins.range_spacing_m)) - 1);
  return fmt::format(
      "level ground in range bins {} to {} lies more than 87 degrees below the antenna: their power is "
      "right, the "
      "azimuths over which the beam spreads it are not",
      first, last);
}

void add_warnings(const FramePlan& plan, double off_origin_m, wire::FrameDescriptor& descriptor) {
  if (plan.sum() != nullptr && !plan.sum()->doppler_warning.empty())
    descriptor.add_warnings(plan.sum()->doppler_warning);
  if (plan.sum() != nullptr && plan.sum()->doppler)
    for (const std::string& warning : doppler_warnings(plan.settings(), plan.sum()->doppler->velocity()))
      descriptor.add_warnings(warning);
  for (const std::string& warning : sea_warnings(plan.looks_at())) descriptor.add_warnings(warning);
  const WorldFrame& frame = plan.scene().world().frame;
  for (const std::string& warning : {refraction_warning(plan), steep_beam_warning(plan)})
    if (!warning.empty()) descriptor.add_warnings(warning);
  const bool far = off_origin_m > kFarFromOrigin_m;
  if (!plan.looks_at().extent().any)
    descriptor.add_warnings(far ? fmt::format("no known ground in the sector: the antenna is {:.0f} km from "
                                              "the scene's origin, and bins and picture are empty",
                                              off_origin_m / 1000)
                                : "no known ground in the sector");
  if (far && plan.looks_at().extent().any && std::isfinite(frame.radius_factor()))
    descriptor.add_warnings(
        fmt::format("antenna {:.1f} km from the scene origin: azimuths are off by up to {:.3g} degrees, "
                    "slant ranges by {:.3g} m",
                    off_origin_m / 1000, descriptor.azimuth_error_bound_rad() / kDegree_rad,
                    shear_bound_m(plan, off_origin_m)));
}

/// tan|elevation| of the steepest line of sight into the sector's box, down or up; at most 70.7.
double steepest_tangent(const FramePlan& plan) {
  constexpr double kGreatestSine = 0.9999;
  const double below_m = plan.looks_at().box().antenna_above_bottom_m;
  const double r_min_m = plan.bins().r_min_m;
  const double down = below_m <= 0                        ? 0
                      : below_m < kGreatestSine * r_min_m ? below_m / r_min_m
                                                          : kGreatestSine;
  const double up = std::sin(plan.looks_at().extent().highest_elevation_rad);
  const double sine = std::clamp(std::max(down, up), 0.0, kGreatestSine);
  return sine / std::sqrt(1 - sine * sine);
}

constexpr std::size_t kMostEntries = 50;
constexpr std::size_t kLongestText = 500;

template <typename T>
std::span<const T> first_of(const std::vector<T>& all) {
  return std::span(all).first(std::min(all.size(), kMostEntries));
}

std::string cut(const std::string& text) {
  return text.size() <= kLongestText ? text : text.substr(0, kLongestText) + "...";
}

/// What the ground of a frame was made of, and what loading warned of. Lists that would fill the message are
/// cut: the log has them all.
void describe_load(const LoadReport& report, wire::FrameDescriptor& descriptor) {
  wire::LoadedGround& ground = *descriptor.mutable_ground();
  ground.set_lowest_m(report.lowest_m);
  ground.set_highest_m(report.highest_m);
  ground.set_water_km2(report.water_m2 / 1e6);
  for (const ElevationSource& source : first_of(report.elevation)) {
    wire::ElevationModel& row = *ground.add_elevation();
    row.set_file(cut(source.file));
    row.set_unit(cut(source.unit));
    row.set_unit_assumed(source.unit_assumed);
  }
  for (const BuildingHeights& source : first_of(report.building_heights)) {
    wire::BuildingHeights& row = *ground.add_building_heights();
    row.set_file(cut(source.file));
    row.set_field(cut(source.field));
    row.set_unit(source.unit);
    row.set_found(source.found);
    row.set_least_m(source.least_m);
    row.set_median_m(source.median_m);
    row.set_most_m(source.most_m);
    row.set_by_default(source.by_default);
    row.set_default_m(source.default_m);
  }
  for (const std::string& warning : first_of(report.warnings)) descriptor.add_warnings(cut(warning));
}

void write_materials(const Scene& scene, wire::FrameDescriptor& descriptor) {
  for (const Material& material : scene.materials()) {
    wire::Material& row = *descriptor.add_materials();
    row.set_name(material.name);
    row.set_model(model_name(material.model));
    row.set_gamma(material.gamma);
    row.set_reflectivity(material.reflectivity);
    row.set_rms_slope(material.rms_slope);
    row.set_plate_tau(material.plate_tau);
    row.set_plate_exponent(material.plate_exponent);
  }
}

}  // namespace

std::string scene_hash(const Scene& scene) {
  const std::string& world_sum = scene.world().report.world_sum;
  if (world_sum.empty()) return {};
  wire::FrameDescriptor with_materials;
  write_materials(scene, with_materials);
  CacheKey key;
  key.add("world", world_sum);
  for (const wire::Material& material : with_materials.materials())
    key.add("material", material.SerializeAsString());
  return key.name();
}

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
  if (pose.settings.tilt_auto)
    descriptor.mutable_pose()->set_tilt_deg(plan.looks_at().antenna_gain().tilt_rad() / kDegree_rad);
  descriptor.set_origin_latitude_deg(world.frame.origin_latitude_rad() / kDegree_rad);
  descriptor.set_origin_longitude_deg(world.frame.origin_longitude_rad() / kDegree_rad);
  descriptor.set_radius_factor(world.frame.radius_factor());
  descriptor.set_antenna_x_m(pose.antenna.m.x);
  descriptor.set_antenna_y_m(pose.antenna.m.y);
  descriptor.set_antenna_z_m(pose.antenna.m.z);
  descriptor.set_north_rad(pose.north_rad);
  descriptor.set_wavelength_m(plan.looks_at().wavelength_m());
  descriptor.set_azimuth_start_deg(pose.settings.bearing_deg - plan.settings().sector_deg / 2);
  descriptor.set_azimuth_width_deg(plan.settings().sector_deg / bins.n_azimuth);
  descriptor.set_range_start_m(bins.r_min_m);
  descriptor.set_range_spacing_m(bins.range_spacing_m);
  descriptor.set_phase_sign(-1);
  // Normalised amplitudes are multiplied by r^2.
  const bool normalised = plan.settings().range_normalisation;
  descriptor.set_unit(normalised ? "sqrt(W) m^2" : "sqrt(W)");
  descriptor.set_power_unit(normalised ? "W m^4" : "W");
  descriptor.set_azimuth_reference("clockwise from the antenna's true north");
  descriptor.set_bottom_y_m(plan.looks_at().extent().bottom_y_m);
  descriptor.set_top_y_m(plan.looks_at().extent().top_y_m);
  descriptor.set_map_reference_height_m(plan.looks_at().extent().median_height_m);
  // At most rho / (k R) tan|elevation|, rho the antenna's distance from the scene origin (PAPER.md).
  const double rho_m = std::hypot(pose.antenna.m.x, pose.antenna.m.z);
  descriptor.set_azimuth_error_bound_rad(rho_m / (world.frame.radius_factor() * kMeanEarthRadius_m) *
                                         steepest_tangent(plan));
  write_materials(plan.scene(), descriptor);
  descriptor.set_scene_hash(scene_hash(plan.scene()));
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

void describe_receiver(const Receiver& receiver, wire::FrameDescriptor& descriptor) {
  descriptor.set_adc_step(receiver.iq_step());
  descriptor.set_video_floor_db(receiver.video_scale().floor_db);
  if (receiver.noise_power_w() == 0) return;
  descriptor.set_noise_power_w(receiver.noise_power_w());
  descriptor.set_noise_counter(receiver.counter());
}

void summarise_frame(const FramePlan& plan, const FrameStats& stats, wire::FrameSummary& summary) {
  summary.set_rays(stats.rays);
  summary.set_hits(stats.hits);
  summary.set_samples(stats.samples);
  summary.set_repaired(stats.repaired);
  summary.set_rejected(stats.rejected);
  summary.set_coverage(stats.coverage());
  summary.set_buildings_seen(plan.looks_at().seen().count());
  summary.set_lit_bins(stats.lit_bins);
  summary.set_unsampled_bins(stats.unsampled_bins);
  if (const std::string warning = unsampled_warning(stats, plan.settings()); !warning.empty())
    summary.add_warnings(warning);
}

std::vector<std::string> frame_warnings(const wire::FrameDescriptor& descriptor,
                                        const wire::FrameSummary& summary) {
  std::vector<std::string> warnings(descriptor.warnings().begin(), descriptor.warnings().end());
  warnings.insert(warnings.end(), summary.warnings().begin(), summary.warnings().end());
  if (summary.coverage() < 1) {
    const double percent = 100 * (1 - summary.coverage());
    warnings.push_back(
        fmt::format("{} % of the sector has no known ground",
                    percent < 10 ? fmt::format("{:.2g}", percent) : fmt::format("{:.0f}", percent)));
  }
  return warnings;
}

double compass_deg(double bearing_deg) { return std::fmod(std::fmod(bearing_deg, 360) + 360, 360); }

}  // namespace obliq
