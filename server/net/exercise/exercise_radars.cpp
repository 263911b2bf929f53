#include "server/net/exercise/exercise_radars.h"

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"
#include "server/radar/frame_plan.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {
namespace {

const std::string& name_of(const wire::RadarState& state) { return state.radar(); }

/// As the state has it; what is wrong with it is its own part's to say.
PoseSettings platform_pose(const Platform& platform, const wire::ExerciseState& state) {
  PoseSettings pose = platform.initial;
  const auto name = [](const wire::PlatformState& its) { return its.platform(); };
  if (const auto* its = state_of(platform.name, state.platforms(), name))
    (void)merge_message(its->pose(), pose);
  return pose;
}

}  // namespace

void ExerciseRadars::write(wire::ExerciseState& state) const {
  for (const LiveRadar& radar : room_.radars().all()) {
    wire::RadarState& its = *state.add_radars();
    its.set_radar(radar.name);
    write_message(radar.settings.current()->settings, *its.mutable_settings());
    write_message(radar.pose, *its.mutable_pose());
    its.set_transmit_off(!radar.transmit);
    its.set_frozen(radar.frozen);
    its.set_rate_limit_hz(radar.rate_limit_hz);
  }
}

std::vector<FieldError> ExerciseRadars::faults(const wire::ExerciseState& state) {
  const auto faults = [&](const LiveRadar& radar, const wire::RadarState& its) {
    std::vector<FieldError> errors;
    Wanted wanted = read(radar, its, errors);
    if (radar.platform)
      wanted.config.pose =
          riding(platform_pose(*radar.platform, state), radar.initial.mount, wanted.config.pose);
    return errors.empty() ? faults_of(wanted) : errors;
  };
  return faults_of_each("radar", room_.radars().all(), state.radars(), name_of, faults);
}

void ExerciseRadars::take(const wire::ExerciseState& state, const std::string& by) {
  for (std::size_t i = 0; i < room_.radars().all().size(); ++i) {
    LiveRadar& radar = room_.radars().at(i);
    std::vector<FieldError> none;
    put(radar, read(radar, *state_of(radar.name, state.radars(), name_of), none), by);
  }
}

void ExerciseRadars::reset(const std::string& name, const std::string& by) {
  for (std::size_t i = 0; i < room_.radars().all().size(); ++i) {
    LiveRadar& radar = room_.radars().at(i);
    if (name.empty() || name == radar.name) put(radar, {.config = radar.initial}, by);
  }
}

void ExerciseRadars::freeze(bool on) { room_.radars().hold(on); }

ExerciseRadars::Wanted ExerciseRadars::read(const LiveRadar& radar, const wire::RadarState& state,
                                            std::vector<FieldError>& errors) {
  Wanted wanted{radar.initial, !state.transmit_off(), state.frozen(), state.rate_limit_hz()};
  append(errors, merge_message(state.settings(), wanted.config.settings));
  append(errors, merge_message(state.pose(), wanted.config.pose));
  return wanted;
}

std::vector<FieldError> ExerciseRadars::faults_of(const Wanted& wanted) const {
  const RadarSettings& settings = wanted.config.settings;
  std::vector<FieldError> errors = validate(wanted.config);
  if (auto fault = room_.rate_limit_fault(wanted.rate_limit_hz)) errors.push_back(std::move(*fault));
  if (errors.empty()) errors = room_.renderer().scene_faults(settings);
  if (errors.empty())
    if (const auto over = room_.over_live_limit(settings, wire::kAllPlanes)) errors.push_back(over->field);
  if (errors.empty()) errors = room_.renderer().place(wanted.config.pose);
  // What the ground decides shows as the radar's fault, as after a move.
  if (errors.empty()) errors = known_beam_faults(settings, wanted.config.pose).value_or(errors);
  return errors;
}

void ExerciseRadars::put(LiveRadar& radar, const Wanted& wanted, const std::string& by) {
  Radars& radars = room_.radars();
  (void)radar.settings.set(wanted.config.settings);
  // A clock of its own begins with the next pose that has one.
  const PoseSettings& pose = wanted.config.pose;
  const Platform* platform = radar.platform;  // which is where it is to be by now
  (void)radars.take_pose(radar, platform ? riding(platform->pose, radar.initial.mount, pose) : pose, false);
  radar.forget_heading();
  radar.rate_limit_hz = wanted.rate_limit_hz;
  radars.flip(radar, {std::nullopt, false}, by);  // for a moment: what is frozen is the state that is put
  radars.show(radar);
  radars.check_windows(radar);
  radars.flip(radar, {wanted.transmit, wanted.frozen}, by);
  radars.update_demand(radar);
}

}  // namespace obliq::net
