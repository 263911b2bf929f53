#include "server/net/exercise/exercise.h"

#include <algorithm>

#include "proto/obliq.pb.h"
#include "server/log/log.h"
#include "server/net/exercise/exercise_platforms.h"
#include "server/net/exercise/exercise_radars.h"
#include "server/net/exercise/exercise_targets.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"

namespace obliq::net {

Exercise::Exercise(Room& room) : room_(room) {
  join(std::make_unique<ExercisePlatforms>(room));  // before what rides on them
  join(std::make_unique<ExerciseRadars>(room));
  join(std::make_unique<ExerciseTargets>(room));
}

wire::ExerciseState Exercise::for_all() const {
  wire::ExerciseState state;
  write(state);
  hide_targets(state);
  return state;
}

void Exercise::hide_targets(wire::ExerciseState& state) {
  state.clear_targets();
  state.set_with_targets(false);
}

void Exercise::write(wire::ExerciseState& state) const {
  state.set_version(kExerciseVersion);
  state.set_scene_hash(room_.renderer().scene_hash());
  state.set_scene_name(room_.options().scene_name);
  state.set_build(room_.options().server_version);
  for (const auto& part : parts_) part->write(state);
}

std::vector<FieldError> Exercise::load(const wire::ExerciseState& state, const std::string& by) {
  std::vector<FieldError> errors;
  if (state.version() < 1 || state.version() > kExerciseVersion)
    errors.push_back({"version", std::to_string(state.version()),
                      "1 to " + std::to_string(kExerciseVersion) + ", by a server of this version"});
  if (const std::string here = room_.renderer().scene_hash(); state.scene_hash() != here)
    errors.push_back(
        {"scene_hash", presentable(state.scene_hash() + " of " + state.scene_name()),
         presentable(here + " of " + room_.options().scene_name + ": the scene that is served")});
  if (!errors.empty()) return errors;
  for (const auto& part : parts_) append(errors, part->faults(state));
  if (!errors.empty()) return errors;
  for (const auto& part : parts_) part->take(state, by);
  wire::ExerciseState told = state;
  hide_targets(told);
  room_.log().loaded(told, by);
  log_info("exercise: a state of {} radars loaded by {}", state.radars_size(), by);
  return {};
}

void Exercise::reset(const std::string& name, const std::string& by) {
  for (const auto& part : parts_) part->reset(name, by);
  wire::ExerciseState all = for_all();
  if (!name.empty())
    all.mutable_radars()->erase(
        std::remove_if(all.mutable_radars()->begin(), all.mutable_radars()->end(),
                       [&](const wire::RadarState& radar) { return radar.radar() != name; }),
        all.mutable_radars()->end());
  room_.log().reset(name, all, by);
  log_info("exercise: {} reset to the scene file by {}", name.empty() ? "all" : "radar " + name, by);
}

void Exercise::freeze(bool on, const std::string& by) {
  if (on == frozen_) return;
  frozen_ = on;
  for (const auto& part : parts_) part->freeze(on);
  room_.log().froze(on, by);
  log_info("exercise: {} by {}", on ? "frozen" : "goes on", by);
}

}  // namespace obliq::net
