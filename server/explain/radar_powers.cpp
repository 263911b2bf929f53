#include "server/explain/radar_powers.h"

#include "server/accuracy/truth_bins.h"
#include "server/radar/frame_plan.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

std::vector<double> power_of(const RadarView& view, const RadarSettings& settings) {
  const PlanResult planned = plan_frame(
      view.scene, std::make_shared<const SettingsSnapshot>(SettingsSnapshot{settings, 1}), view.pose);
  if (!planned.plan) throw InputError("radar \"" + view.radar + "\": " + all_text(planned.errors));
  return render_sample(*planned.plan, view.wedges, view.threads, 1, false).power_w;
}

}  // namespace

RadarPowers measure_radar_powers(const RadarView& view, RadarSettings settings) {
  settings.receiver = {};
  settings.atmosphere = {};
  settings.speckle = SpeckleKind::ground;
  RadarPowers powers;
  powers.own_w = power_of(view, settings);
  const RangeBins ranges = range_bins(settings);
  const auto without = [&](auto&& change) {
    RadarSettings changed = settings;
    change(changed);
    return power_change(powers.own_w, power_of(view, changed), ranges);
  };
  if (settings.beam.pattern != BeamPattern::off)
    powers.without_beam = without([](RadarSettings& s) { s.beam.pattern = BeamPattern::off; });
  if (settings.beam.elevation != ElevationPattern::off)
    powers.without_elevation = without([](RadarSettings& s) { s.beam.elevation = ElevationPattern::off; });
  if (settings.pulse.kind != PulseKind::off)
    powers.without_pulse = without([](RadarSettings& s) { s.pulse.kind = PulseKind::off; });
  return powers;
}

}  // namespace obliq
