#include "server/control/parameters.h"

#include <algorithm>
#include <array>

namespace obliq {

namespace {

// The lists follow their enumerations.
constexpr std::array kFrustumKinds{Choice{"symmetric", "SYMMETRIC"}, Choice{"oblique", "OBLIQUE"},
                                   Choice{"polar", "POLAR"}, Choice{"sweep", "SWEEP"}};
constexpr std::array kPlateKinds{Choice{"spread", "SPREAD_PLATES"}, Choice{"nearest", "NEAREST_PLATES"}};
constexpr std::array kSpeckleKinds{Choice{"ground", "GROUND_SPECKLE"},
                                   Choice{"geometric", "GEOMETRIC_SPECKLE"}};
constexpr std::array kHeightReferences{Choice{"datum", "DATUM"}, Choice{"ground", "GROUND"},
                                       Choice{"ellipsoid", "ELLIPSOID"}};

using enum ModbusWords;
[[maybe_unused]] constexpr ModbusColumn kNoModbus;
constexpr auto kRadar = WireMessage::radar_settings;
constexpr auto kPose = WireMessage::pose;

// Limits. Frequency: VHF to the millimetre band, wavelength 10 m to 1 mm. Ranges: 500 km is the horizon from
// 15 km up over a 4/3 earth; beyond it the world frame's accuracy is not promised. Bins: a frame of
// 8192 x 8192 takes 1.4 GB. Undulation: the geoid lies -107 to +86 m from the ellipsoid (EGM2008).
//
// Modbus: an integer's count is the finest round one that fits the limits into 32 bits: 1e-7 deg of longitude
// is 1 cm, 1e-6 deg of bearing 2 mm at 100 km. Addresses never change their meaning: new parameters go into
// the gaps.
const std::array kParameters{
    Parameter{{"antenna.latitude_deg",
               "deg",
               closed(-90, 90),
               {},
               "Geodetic latitude of the antenna; a scene file that names none means the terrain's centre."},
              Change::live,
              kPose,
              "latitude_deg",
              {200, i32, 1e7},
              [](RadarConfig& c) -> Slot { return &c.pose.latitude_deg; }},
    Parameter{{"antenna.longitude_deg",
               "deg",
               closed(-180, 180),
               {},
               "Longitude of the antenna, east positive; without one, the terrain's centre."},
              Change::live,
              kPose,
              "longitude_deg",
              {202, i32, 1e7},
              [](RadarConfig& c) -> Slot { return &c.pose.longitude_deg; }},
    Parameter{
        {"antenna.height_m", "m", closed(-1000, 100000), {}, "Height of the antenna above its reference."},
        Change::live,
        kPose,
        "height_m",
        {204, i32, 1e3},
        [](RadarConfig& c) -> Slot { return &c.pose.height_m; }},
    Parameter{{"antenna.height_reference",
               "",
               {},
               kHeightReferences,
               "What the height counts from: the terrain's datum, the ground below, or the WGS84 ellipsoid."},
              Change::live,
              kPose,
              "height_reference",
              {206, u16},
              [](RadarConfig& c) -> Slot { return &c.pose.height_reference; }},
    Parameter{{"antenna.geoid_undulation_m",
               "m",
               closed(-120, 120),
               {},
               "Height of the datum above the ellipsoid at the antenna; needed with \"ellipsoid\" only."},
              Change::live,
              kPose,
              "geoid_undulation_m",
              {207, i32, 1e3},
              [](RadarConfig& c) -> Slot { return &c.pose.geoid_undulation_m; }},
    Parameter{{"antenna.bearing_deg",
               "deg",
               closed(-360, 360),
               {},
               "Centre of the sector, clockwise from true north at the antenna."},
              Change::live,
              kPose,
              "bearing_deg",
              {210, i32, 1e6},
              [](RadarConfig& c) -> Slot { return &c.pose.bearing_deg; }},
    Parameter{
        {"antenna.sim_time_ns", "ns", {}, {}, "Time of the pose in the controller's clock; only echoed."},
        Change::live,
        kPose,
        "sim_time_ns",
        {212, i64},
        [](RadarConfig& c) -> Slot { return &c.pose.sim_time_ns; }},
    Parameter{{"antenna.pose_id", "", {}, {}, "The controller's number of the pose; only echoed."},
              Change::live,
              kPose,
              "pose_id",
              {216, u64},
              [](RadarConfig& c) -> Slot { return &c.pose.pose_id; }},
    Parameter{{"radar.frequency_ghz", "GHz", closed(0.03, 300), {}, "Carrier frequency."},
              Change::live,
              kRadar,
              "frequency_ghz",
              {232, wavelength},
              [](RadarConfig& c) -> Slot { return &c.settings.frequency_ghz; }},
    Parameter{{"radar.sector_deg",
               "deg",
               above(0, 360),
               {},
               "Width of the sector in azimuth; the symmetric frustum needs less than 180."},
              Change::live,
              kRadar,
              "sector_deg",
              {234, i32, 1e6},
              [](RadarConfig& c) -> Slot { return &c.settings.sector_deg; }},
    Parameter{
        {"radar.r_min_m", "m", closed(0, 500e3), {}, "Slant range of the near edge of the first range bin."},
        Change::live,
        kRadar,
        "r_min_m",
        {236, i32, 1e3},
        [](RadarConfig& c) -> Slot { return &c.settings.r_min_m; }},
    Parameter{
        {"radar.r_max_m", "m", above(0, 500e3), {}, "Slant range of the far edge of the last range bin."},
        Change::live,
        kRadar,
        "r_max_m",
        {238, i32, 1e3},
        [](RadarConfig& c) -> Slot { return &c.settings.r_max_m; }},
    Parameter{{"radar.power_w", "W", closed(0, 1e12), {}, "Transmitted power; 0: a radar that is silent."},
              Change::live,
              kRadar,
              "power_w",
              {240, f32},
              [](RadarConfig& c) -> Slot { return &c.settings.power_w; }},
    Parameter{
        {"radar.gain_db", "dB", closed(-100, 100), {}, "One-way antenna gain, the same in all directions."},
        Change::live,
        kRadar,
        "gain_db",
        {242, i32, 1e3},
        [](RadarConfig& c) -> Slot { return &c.settings.gain_db; }},
    Parameter{
        {"radar.range_normalisation", "", {}, {}, "Multiply amplitudes by range squared, phase untouched."},
        Change::live,
        kRadar,
        "range_normalisation",
        {244, u16},
        [](RadarConfig& c) -> Slot { return &c.settings.range_normalisation; }},
    Parameter{
        {"radar.speckle",
         "",
         {},
         kSpeckleKinds,
         "Speckle that belongs to the ground, or the paper's, that comes from the samples' own ranges."},
        Change::live,
        kRadar,
        "speckle",
        {245, u16},
        [](RadarConfig& c) -> Slot { return &c.settings.speckle; }},
    Parameter{{"radar.speckle_seed", "", {}, {}, "Another seed, another speckle pattern on the same ground."},
              Change::live,
              kRadar,
              "speckle_seed",
              {246, i64},
              [](RadarConfig& c) -> Slot { return &c.settings.speckle_seed; }},
    Parameter{
        {"frustum.kind",
         "",
         {},
         kFrustumKinds,
         "How the ground is sampled: rays through pixels of three layouts, or vertical planes without rays."},
        Change::live,
        kRadar,
        "frustum",
        {250, u16},
        [](RadarConfig& c) -> Slot { return &c.settings.frustum; }},
    Parameter{{"frustum.plates",
               "",
               {},
               kPlateKinds,
               "Spread a pixel's light over all range bins that it covers, or give it to the bin of its hit, "
               "as the paper does."},
              Change::live,
              kRadar,
              "plates",
              {251, u16},
              [](RadarConfig& c) -> Slot { return &c.settings.plates; }},
    Parameter{{"frustum.pixel_columns",
               "",
               closed(1, 16384),
               {},
               "Pixels across the sector, or planes of the sweep, rounded up to whole ones an azimuth bin; "
               "frustum.pixels sets columns and rows alike."},
              Change::live,
              kRadar,
              "pixel_columns",
              {252, u16},
              [](RadarConfig& c) -> Slot { return &c.settings.pixel_columns; }},
    Parameter{{"frustum.pixel_rows",
               "",
               closed(1, 16384),
               {},
               "Pixels along range, none with the sweep; frustum.pixels = [columns, rows] sets both."},
              Change::live,
              kRadar,
              "pixel_rows",
              {253, u16},
              [](RadarConfig& c) -> Slot { return &c.settings.pixel_rows; }},
    Parameter{{"bins.azimuth", "", closed(1, 8192), {}, "Azimuth bins in the sector."},
              Change::live,
              kRadar,
              "azimuth_bins",
              {254, u16},
              [](RadarConfig& c) -> Slot { return &c.settings.azimuth_bins; }},
    Parameter{{"bins.range", "", closed(1, 8192), {}, "Range bins between r_min and r_max."},
              Change::live,
              kRadar,
              "range_bins",
              {255, u16},
              [](RadarConfig& c) -> Slot { return &c.settings.range_bins; }},
};

}  // namespace

std::span<const Parameter> parameters() { return kParameters; }

const Parameter* find_parameter(std::string_view name) {
  const auto found =
      std::ranges::find_if(kParameters, [&](const Parameter& p) { return p.key.name == name; });
  return found == kParameters.end() ? nullptr : &*found;
}

Value value_of(const Parameter& parameter, RadarConfig config) {
  return load(parameter.key, parameter.slot(config));
}

}  // namespace obliq
