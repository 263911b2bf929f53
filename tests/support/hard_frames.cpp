#include "tests/support/hard_frames.h"

#include <array>
#include <cmath>
#include <sstream>

#include "server/control/parameters.h"
#include "server/radar/frame_plan.h"
#include "server/radar/receiver/receiver.h"
#include "server/radar/render.h"
#include "server/scene/embree_tracer.h"
#include "tests/support/made_worlds.h"
#include "tests/support/random_scenes.h"
#include "tests/support/scenes.h"

namespace obliq::test {
namespace {

std::shared_ptr<const Scene> bare_hills() {
  return make_scene(load_world(synthetic_spec(SyntheticKind::hills, 12000, 30)));
}

/// Thousands of buildings, some of them large, around the antenna and far off, and a hole in the ground.
std::shared_ptr<const Scene> town() {
  World world = made_world(9000, 25, [](double x, double z) {
    const bool hole = std::hypot(x - 3000, z - 2000) < 800;
    return hole ? kUnknown : 60 * std::sin(x / 700) * std::cos(z / 900);
  });
  Dice dice(27);
  for (int k = 0; k < 6000; ++k) {
    const double x = dice.uniform(-8000, 8000), z = dice.uniform(-8000, 8000);
    if (std::hypot(x - 3000, z - 2000) < 1100) continue;
    add_prism(world, rectangle(x, z, dice.logarithmic(3, 200), dice.logarithmic(3, 200)),
              dice.logarithmic(2, 80));
  }
  return make_scene(std::move(world));
}

/// Of any order up to the limit, and often the limit itself.
int size(Dice& dice, int most) {
  return dice.chance(0.2) ? most : static_cast<int>(dice.logarithmic(1, most));
}

/// Settings, most of them at some limit or other.
RadarSettings random_settings(Dice& dice) {
  RadarSettings s;
  s.sector_deg = dice.one_of({1e-9, 0.05, 0.5, 8.0, 60.0, 120.0, 179.0, 360.0});
  s.r_min_m = dice.one_of({0.0, 50.0, 900.0, 2500.0});
  s.r_max_m = s.r_min_m + dice.one_of({0.5, 300.0, 6000.0, 60e3, 400e3});
  s.frustum =
      dice.one_of({FrustumKind::sweep, FrustumKind::sweep, FrustumKind::oblique, FrustumKind::symmetric});
  s.plates = dice.one_of({PlateKind::spread, PlateKind::nearest});
  s.speckle =
      dice.one_of({SpeckleKind::ground, SpeckleKind::geometric, SpeckleKind::none, SpeckleKind::independent});
  s.sub_columns = dice.one_of({0, 16, 64, 1024});
  s.azimuth_bins = dice.chance(0.3) ? 1 : size(dice, 8192);
  s.range_bins = size(dice, 8192);
  s.pixel_columns = size(dice, 16384);
  s.pixel_rows = size(dice, 16384);
  s.range_normalisation = dice.chance(0.3);
  s.scan_mode = dice.one_of({ScanMode::frame, ScanMode::frame, ScanMode::circular});
  s.beam.pattern = dice.one_of(
      {BeamPattern::off, BeamPattern::off, BeamPattern::uniform, BeamPattern::taylor, BeamPattern::gaussian});
  s.beam.width_deg = dice.one_of({0.05, 0.5, 3.0, 30.0});
  s.beam.extent_deg = dice.one_of({0.0, 5.0, 180.0});
  s.beam.elevation = dice.one_of({ElevationPattern::off, ElevationPattern::gaussian});
  s.pulse.kind = dice.one_of({PulseKind::off, PulseKind::off, PulseKind::rectangular, PulseKind::compressed});
  s.pulse.length_us = dice.one_of({0.01, 1.0, 100.0});
  s.pulse.bandwidth_mhz = dice.one_of({0.0, 1.0, 70.0});
  s.pulse.extent_bins = dice.one_of({1, 16, 256});
  s.receiver.noise = dice.chance(0.4);
  s.video.looks = dice.one_of({1, 8, 1024});
  return s;
}

/// What stands against one of the settings is left out, until they are legal.
bool make_legal(RadarSettings& s, Dice& dice) {
  for (int attempt = 0; attempt < 8; ++attempt) {
    if (validate(s).empty()) return true;
    const RadarSettings other = random_settings(dice);
    if (attempt < 4)
      s.azimuth_bins = other.azimuth_bins, s.range_bins = other.range_bins, s.pulse = other.pulse;
    if (s.frustum == FrustumKind::sweep && s.speckle == SpeckleKind::geometric) s.speckle = other.speckle;
    s.beam = attempt < 6 ? other.beam : BeamSettings{};
    if (attempt >= 4) s.pulse = {}, s.speckle = SpeckleKind::ground, s.scan_mode = ScanMode::frame;
  }
  return false;
}

}  // namespace

std::optional<HardFrame> hard_frame(std::uint64_t seed) {
  static const std::array scenes{bare_hills(), town()};
  [[maybe_unused]] static const bool built = scenes[1]->tracer().bytes() > 0;  // as a server does beforehand
  Dice dice(seed);
  HardFrame frame;
  RadarSettings& s = frame.settings = random_settings(dice);
  if (!make_legal(s, dice)) return std::nullopt;
  frame.scene = scenes[static_cast<std::size_t>(dice.integer(0, 1))];
  frame.pose =
      pose_over_origin(frame.scene->world(), dice.one_of({100.0, 400.0, 1400.0}), dice.uniform(0, 360));
  if (!beam_faults(frame.scene, s, frame.pose).empty()) return std::nullopt;
  std::ostringstream text;
  text << "seed " << seed << ": " << frustum_name(s.frustum) << ", " << s.azimuth_bins << " x "
       << s.range_bins << " bins, " << s.pixel_columns << " x " << s.pixel_rows << " pixels, " << s.sector_deg
       << " deg, " << s.r_min_m << " to " << s.r_max_m << " m, sub-columns " << s.sub_columns;
  if (s.beam.pattern != BeamPattern::off)
    text << ", beam " << s.beam.width_deg << " deg to " << s.beam.extent_deg;
  if (s.pulse.kind != PulseKind::off) text << ", pulse " << s.pulse.length_us << " us";
  frame.text = text.str();
  return frame;
}

HardWork render_heard(const HardFrame& frame, HeardWork& heard) {
  HardWork work;
  work.whole = hear(heard, [&] {
    const RadarSettings& settings = frame.settings;
    const PlanResult planned = plan_frame(frame.scene, snapshot(settings), frame.pose);
    if (!planned.plan) return;
    const FramePlan& plan = *planned.plan;
    const Receiver receiver(settings, "main", 1, air_view(plan.looks_at()));
    FrameSum sum(settings);
    RenderOptions options;
    options.threads = 1;
    options.receiver = &receiver;
    options.video8 = true;
    options.labels = true;
    options.on_wedge = [&](Wedge&& wedge) { sum.add(wedge); };
    if (!render_wedges(plan, {0, settings.azimuth_bins}, options)) throw Stopped{};
    work.stats = sum.total();
    if (const EchoPlan* echo = plan.sum())
      // At least as many weights as level ground has.
      work.products += static_cast<std::int64_t>(echo->n_taps - 2 * echo->kernels.unused.front()) *
                       static_cast<std::int64_t>(echo->steepest.size()) * EchoPlan::kTile *
                       settings.azimuth_bins;
  });
  return work;
}

}  // namespace obliq::test
