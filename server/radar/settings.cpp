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

RadarSettings sharp_settings(RadarSettings settings) {
  if (draws_speckle(settings) || settings.speckle == SpeckleKind::automatic)
    settings.speckle = SpeckleKind::ground;
  settings.beam = {};
  settings.pulse = {};
  settings.receiver = {};
  settings.atmosphere = {};
  return settings;
}

bool has_receiver(const RadarSettings& settings) {
  return settings.receiver.is_on() || settings.atmosphere.rain_mm_h > 0;
}

bool normalises_samples(const RadarSettings& settings) {
  return settings.range_normalisation && !has_receiver(settings);
}

bool same_antenna(PoseSettings a, const PoseSettings& b) {
  a.sim_time_ns = b.sim_time_ns;
  a.pose_id = b.pose_id;
  a.valid_s = b.valid_s;
  return a == b;
}

}  // namespace obliq
