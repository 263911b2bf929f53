#include "server/radar/settings.h"

namespace obliq {

std::string frustum_name(FrustumKind kind) {
  switch (kind) {
    case FrustumKind::symmetric:
      return "symmetric";
    case FrustumKind::oblique:
      return "oblique";
    case FrustumKind::polar:
      return "polar";
    default:
      return "sweep";
  }
}

std::string plates_name(PlateKind plates) { return plates == PlateKind::nearest ? "nearest" : "spread"; }

SpeckleKind resolved_speckle(const RadarSettings& settings) {
  if (settings.speckle != SpeckleKind::automatic) return settings.speckle;
  const bool turns = settings.scan_mode != ScanMode::frame && settings.beam.pattern != BeamPattern::off;
  return turns ? SpeckleKind::independent : SpeckleKind::ground;
}

std::vector<FieldError> sampling_faults(const RadarSettings& settings) {
  std::vector<FieldError> errors;
  if (settings.frustum == FrustumKind::polar)
    errors.push_back(
        {"frustum.kind", "\"polar\", which only recordings have", "\"symmetric\" | \"oblique\" | \"sweep\""});
  if (settings.frustum == FrustumKind::sweep && settings.speckle == SpeckleKind::geometric)
    errors.push_back({"radar.speckle", "\"geometric\" with frustum.kind = \"sweep\"",
                      "\"ground\", \"none\", \"independent\" or \"auto\", or frustum.kind = \"oblique\" or "
                      "\"symmetric\", whose rays it needs"});
  return errors;
}

std::vector<std::string> flat_plates(const std::vector<Material>& materials) {
  std::vector<std::string> names;
  for (const Material& material : materials)
    if (material.used && material.model == ScatteringModel::flat_plate) names.push_back(material.name);
  return names;
}

std::vector<FieldError> flat_plate_faults(const RadarSettings& settings,
                                          const std::vector<Material>& materials) {
  if (settings.frustum != FrustumKind::sweep) return {};
  std::string names;
  for (const std::string& name : flat_plates(materials)) names += (names.empty() ? "" : ", ") + name;
  if (names.empty()) return {};
  return {{"frustum.kind", "\"sweep\" with flat plates (" + names + ")",
           "\"oblique\" or \"symmetric\", whose rays they need, or another materials.NAME.model"}};
}

std::int64_t pulse_samples(const RadarSettings& s) {
  if (s.mode != RadarMode::pulses) return 0;
  const int dwell_bins = s.scan_mode == ScanMode::frame ? s.azimuth_bins : std::max(1, s.scan_dwell_bins);
  const std::int64_t trains = (s.azimuth_bins + dwell_bins - 1) / dwell_bins;
  return trains * s.doppler.pulses * s.range_bins;
}

RadarSettings sharp_settings(RadarSettings settings) {
  if (draws_speckle(settings) || settings.speckle == SpeckleKind::automatic)
    settings.speckle = SpeckleKind::ground;
  settings.mode = RadarMode::map;
  settings.beam = {};
  settings.pulse = {};
  settings.receiver = {};
  // Polarisation and wind stay, by which the sea returns more or less; its texture is chance.
  settings.atmosphere.rain_mm_h = 0;
  settings.atmosphere.gas = false;
  settings.sea.shape = 0;
  return settings;
}

bool has_receiver(const RadarSettings& settings) {
  return settings.receiver.is_on() || settings.atmosphere.rain_mm_h > 0;
}

bool normalises_samples(const RadarSettings& settings) {
  return settings.range_normalisation && !has_receiver(settings);
}

bool same_antenna(const RadarSettings& settings, PoseSettings a, const PoseSettings& b) {
  // The texture of the sea drifts with the wind.
  const bool drifts = (settings.sea.state > 0 || settings.sea.state_auto) && settings.sea.shape > 0 &&
                      settings.atmosphere.wind_m_s > 0;
  if (!drifts) a.sim_time_ns = b.sim_time_ns;
  a.pose_id = b.pose_id;
  a.valid_s = b.valid_s;
  a.time_rate = b.time_rate;
  if (settings.mode == RadarMode::map) {
    a.velocity_north_m_s = b.velocity_north_m_s;
    a.velocity_east_m_s = b.velocity_east_m_s;
    a.velocity_up_m_s = b.velocity_up_m_s;
  }
  if (settings.beam.stabilised ||
      (a.roll_deg == 0 && a.pitch_deg == 0 && b.roll_deg == 0 && b.pitch_deg == 0)) {
    a.heading_deg = b.heading_deg;
    a.roll_deg = b.roll_deg;
    a.pitch_deg = b.pitch_deg;
  }
  return a == b;
}

}  // namespace obliq
