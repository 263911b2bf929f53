// The parameters of the antenna's place, of the radar, its sampling, bins and scan; and all of them together.
#include <array>
#include <vector>

#include "server/control/sections/parameter_row.h"

namespace obliq {
namespace {

// The lists follow their enumerations.
constexpr std::array kFrustumKinds{Choice{"symmetric", "SYMMETRIC"}, Choice{"oblique", "OBLIQUE"},
                                   Choice{"polar", "POLAR", true}, Choice{"sweep", "SWEEP"}};
constexpr std::array kPlateKinds{Choice{"spread", "SPREAD_PLATES"}, Choice{"nearest", "NEAREST_PLATES"}};
constexpr std::array kSpeckleKinds{Choice{"ground", "GROUND_SPECKLE"},
                                   Choice{"geometric", "GEOMETRIC_SPECKLE"}, Choice{"none", "NONE_SPECKLE"},
                                   Choice{"independent", "INDEPENDENT_SPECKLE"},
                                   Choice{"auto", "AUTO_SPECKLE"}};
constexpr std::array kScanModes{Choice{"frame", "FRAME_SCAN"}, Choice{"sector", "SECTOR_SCAN"},
                                Choice{"circular", "CIRCULAR_SCAN"}};

constexpr std::array kModes{Choice{"map", "MAP_MODE"}, Choice{"mti", "MTI_MODE"}, Choice{"dbs", "DBS_MODE"},
                            Choice{"sar", "SAR_MODE"}, Choice{"pulses", "PULSES_MODE"}};

using enum ModbusWords;
constexpr Limits kSpeeds = closed(-kMostSpeed_m_s, kMostSpeed_m_s);

// Limits. Frequency: VHF to the millimetre band, wavelength 10 m to 1 mm. Ranges: 500 km is the horizon from
// 15 km up over a 4/3 earth; beyond it the world frame's accuracy is not promised. Bins: a frame of
// 8192 x 8192 takes 1.4 GB. Undulation: the geoid lies -107 to +86 m from the ellipsoid (EGM2008).
//
// Modbus: an integer's count is the finest round one that fits the limits into 32 bits: 1e-7 deg of longitude
// is 1 cm, 1e-6 deg of bearing 2 mm at 100 km. Addresses never change their meaning: new parameters go into
// the gaps.
const std::array kParameters{
    parameter<&PoseSettings::latitude_deg>(
        "antenna.latitude_deg", "deg", closed(-90, 90), "latitude_deg", {200, i32, 1e7},
        "Geodetic latitude of the antenna; a scene file that names none gets the terrain's centre."),
    parameter<&PoseSettings::longitude_deg>(
        "antenna.longitude_deg", "deg", closed(-180, 180), "longitude_deg", {202, i32, 1e7},
        "Longitude of the antenna, east positive; a scene file that names none gets the terrain's centre."),
    parameter<&PoseSettings::height_m>(
        "antenna.height_m", "m", closed(-1000, 100000), "height_m", {204, i32, 1e3},
        "Height of the antenna above antenna.height_reference.", {.knob = "height"}),
    parameter<&PoseSettings::height_reference>(
        "antenna.height_reference", "", kHeightReferences, "height_reference", {206, u16},
        "Zero of antenna.height_m: the terrain's datum, the ground below, or the WGS84 ellipsoid."),
    parameter<&PoseSettings::geoid_undulation_m>(
        "antenna.geoid_undulation_m", "m", closed(-120, 120), "geoid_undulation_m", {207, i32, 1e3},
        "Height of the datum above the ellipsoid at the antenna; used with \"ellipsoid\" only.",
        {.of_programs = true}),
    parameter<&PoseSettings::bearing_deg>(
        "antenna.bearing_deg", "deg", closed(-360, 360), "bearing_deg", {210, i32, 1e6},
        "Centre of the sector, clockwise from true north at the antenna.", {.knob = "bearing", .aim = true}),
    parameter<&PoseSettings::heading_deg>(
        "antenna.heading_deg", "deg", closed(-360, 360), "heading_deg", {323, i32, 1e6},
        "Heading of the platform that carries the antenna, true; a scene file that names none gets the "
        "bearing.",
        {.of_programs = true}),
    parameter<&PoseSettings::roll_deg>("antenna.roll_deg", "deg", closed(-60, 60), "roll_deg",
                                       {331, i32, 1e6},
                                       "Roll of the platform, right side down positive; an antenna with "
                                       "beam.stabilised = false rolls with it.",
                                       {.of_programs = true}),
    parameter<&PoseSettings::pitch_deg>("antenna.pitch_deg", "deg", closed(-60, 60), "pitch_deg",
                                        {333, i32, 1e6},
                                        "Pitch of the platform, nose up positive; an antenna with "
                                        "beam.stabilised = false pitches with it.",
                                        {.of_programs = true}),
    parameter<&PoseSettings::velocity_north_m_s>(
        "antenna.velocity_north_m_s", "m/s", kSpeeds, "velocity_north_m_s", {325, i32, 1e3},
        "Velocity of the antenna over the ground, its part towards true north; auto: from the poses and "
        "their own times, where there are two. Of the three parts one that is not named beside another is 0.",
        {.of_programs = true}),
    parameter<&PoseSettings::velocity_east_m_s>("antenna.velocity_east_m_s", "m/s", kSpeeds,
                                                "velocity_east_m_s", {327, i32, 1e3},
                                                "The same towards east.", {.of_programs = true}),
    parameter<&PoseSettings::velocity_up_m_s>(
        "antenna.velocity_up_m_s", "m/s", kSpeeds, "velocity_up_m_s", {329, i32, 1e3},
        "The same upwards; from the poses of heights above ground: the change of those heights.",
        {.of_programs = true}),
    parameter<&PoseSettings::time_rate>(
        "antenna.time_rate", "", closed(0.001, 1000), "time_rate", {335, i32, 1e3},
        "Seconds of the controller's clock in a second: 10 where an exercise runs ten times as fast.",
        {.of_programs = true}),
    parameter<&PoseSettings::sim_time_ns>(
        "antenna.sim_time_ns", "ns", closed(-4e18, 4e18), "sim_time_ns", {212, i64},
        "Time of the pose by the controller's clock; the server interpolates between poses that have one.",
        {.of_programs = true}),
    parameter<&PoseSettings::pose_id>("antenna.pose_id", "", kAny, "pose_id", {216, u64},
                                      "The controller's number for the pose; echoed, not used.",
                                      {.of_programs = true}),
    parameter<&PoseSettings::valid_s>(
        "antenna.valid_s", "s", closed(0, 86400), "valid_s", {220, i32, 1e3},
        "A pose is marked stale this long after it arrived if no other has arrived since; 0: never.",
        {.of_programs = true}),
    parameter<&PoseSettings::tilt_deg>(
        "antenna.tilt_deg", "deg", closed(-90, 90), "tilt_deg", {222, i32, 1e3},
        "Elevation of the boresight, up positive; of patterns in elevation. \"auto\" "
        "in a scene file is antenna.tilt_auto.",
        {.knob = "tilt", .aim = true}),
    parameter<&PoseSettings::tilt_auto>(
        "antenna.tilt_auto", "", kAny, "tilt_auto", {224, u16},
        "Tilt towards level ground in the middle of the swath instead of by antenna.tilt_deg.",
        {.knob = "tilt auto", .aim = true}),
    parameter<&RadarSettings::frequency_ghz>("radar.frequency_ghz", "GHz", closed(0.03, 300), "frequency_ghz",
                                             {232, wavelength}, "Carrier frequency."),
    parameter<&RadarSettings::mode>(
        "radar.mode", "", kModes, "mode", {338, u16},
        "What the pulses make: the map of mean echoes, moving targets alone (mti), a "
        "map sharpened by Doppler "
        "(dbs), an image of synthetic aperture (sar), or nothing yet: the samples of "
        "pulse trains (pulses).",
        {.knob = "mode", .not_ideal = true}),
    parameter<&RadarSettings::sector_deg>(
        "radar.sector_deg", "deg", above(0, 360), "sector_deg", {234, i32, 1e6},
        "Width of the sector in azimuth; the symmetric frustum needs less than 180.", {.knob = "sector"}),
    parameter<&RadarSettings::r_min_m>("radar.r_min_m", "m", closed(0, 500e3), "r_min_m", {236, i32, 1e3},
                                       "Slant range of the near edge of the first range bin."),
    parameter<&RadarSettings::r_max_m>("radar.r_max_m", "m", above(0, 500e3), "r_max_m", {238, i32, 1e3},
                                       "Slant range of the far edge of the last range bin."),
    parameter<&RadarSettings::power_w>("radar.power_w", "W", closed(0, 1e12), "power_w", {240, f32},
                                       "Transmitted power; 0: a silent radar."),
    parameter<&RadarSettings::gain_db>(
        "radar.gain_db", "dB", closed(-100, 100), "gain_db", {242, i32, 1e3},
        "One-way antenna gain at its peak; without [beam] the same in all directions."),
    parameter<&RadarSettings::range_normalisation>("radar.range_normalisation", "", kAny,
                                                   "range_normalisation", {244, u16},
                                                   "Multiply amplitudes by range squared; phases stay."),
    parameter<&RadarSettings::speckle>(
        "radar.speckle", "", kSpeckleKinds, "speckle", {245, u16},
        "Speckle fixed to the ground; the paper's, from the ranges of rays, so not with the sweep; none; or "
        "drawn anew for each azimuth bin. auto: independent where an antenna with a beam scans, else "
        "ground."),
    parameter<&RadarSettings::speckle_seed>("radar.speckle_seed", "", kAny, "speckle_seed", {246, i64},
                                            "Each seed gives another speckle pattern on the same ground."),
    parameter<&RadarSettings::frustum>(
        "frustum.kind", "", kFrustumKinds, "frustum", {250, u16},
        "How the ground is sampled: rays through the pixels of a camera, or vertical planes without "
        "rays. A scene file whose [frustum] is empty gets \"sweep\" (frustum.quality = "
        "\"standard\")."),
    parameter<&RadarSettings::plates>(
        "frustum.plates", "", kPlateKinds, "plates", {251, u16},
        "Spread a pixel's power over all range bins that it covers, or put it into the bin of its "
        "hit, as the paper does."),
    parameter<&RadarSettings::pixel_columns>(
        "frustum.pixel_columns", "", closed(1, 16384), "pixel_columns", {252, u16},
        "Pixels across the sector; for the sweep, planes, rounded up to a whole number per azimuth "
        "bin, and at least one each half degree. frustum.pixels sets columns and rows."),
    parameter<&RadarSettings::pixel_rows>(
        "frustum.pixel_rows", "", closed(1, 16384), "pixel_rows", {253, u16},
        "Pixels along range; the sweep has none. frustum.pixels = [columns, rows] sets both."),
    parameter<&RadarSettings::planes_per_bin>(
        "frustum.planes_per_bin", "", closed(0, 1024), "planes_per_bin", {320, u16},
        "Planes in each azimuth bin, of the sweep, where frustum.pixel_columns is not named beside it; 0: as "
        "frustum.quality says. Planes follow the bins, so that a narrower sector of fewer bins costs less."),
    parameter<&RadarSettings::sub_columns>(
        "frustum.sub_columns", "", closed(0, 1024), "sub_columns", {260, u16},
        "The most parts of an azimuth bin that see its buildings, of the sweep; "
        "where parts of 1.5 m are fewer, these do. A multiple of 16 or the next "
        "one; 0: exact planes at each building."),
    parameter<&RadarSettings::azimuth_bins>("bins.azimuth", "", closed(1, 8192), "azimuth_bins", {254, u16},
                                            "Azimuth bins in the sector."),
    parameter<&RadarSettings::range_bins>("bins.range", "", closed(1, 8192), "range_bins", {255, u16},
                                          "Range bins between r_min and r_max."),
    parameter<&RadarSettings::scan_mode>(
        "scan.mode", "", kScanModes, "scan_mode", {256, u16},
        "How a live radar scans: whole frames, back and forth across the sector, or round and round."),
    parameter<&RadarSettings::scan_rate_deg_s>(
        "scan.rate_deg_s", "deg/s", closed(0.1, 7200), "scan_rate_deg_s", {257, i32, 1e3},
        "Turning rate of the antenna; 36 is 6 turns per minute. A pass over the "
        "sector takes 10 ms to 60 s.",
        {.knob = "scan rate"}),
    parameter<&RadarSettings::scan_dwell_bins>(
        "scan.dwell_bins", "", closed(8, 8192), "scan_dwell_bins", {259, u16},
        "Azimuth bins rendered together from one pose; a multiple of 8."),
    parameter<&RadarSettings::scan_bars_deg>(
        "scan.bars", "deg", closed(-90, 90),
        "scan_bars", {},
        "Elevations of the boresight, one a pass of a scan, in turn; empty: antenna.tilt_deg.",
        {.knob = "bars"}),
};

}  // namespace

std::span<const Parameter> parameters() {
  static const std::vector<Parameter> all = [] {
    std::vector<Parameter> list(kParameters.begin(), kParameters.end());
    list.insert(list.end(), beam_parameters().begin(), beam_parameters().end());
    list.insert(list.end(), receiver_parameters().begin(), receiver_parameters().end());
    return list;
  }();
  return all;
}

}  // namespace obliq
