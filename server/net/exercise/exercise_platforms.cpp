#include "server/net/exercise/exercise_platforms.h"

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"

namespace obliq::net {
namespace {

const std::string& name_of(const wire::PlatformState& state) { return state.platform(); }

}  // namespace

void ExercisePlatforms::write(wire::ExerciseState& state) const {
  for (const Platform& platform : room_.radars().platforms()) {
    wire::PlatformState& its = *state.add_platforms();
    its.set_platform(platform.name);
    write_message(platform.pose, *its.mutable_pose());
  }
}

std::vector<FieldError> ExercisePlatforms::faults(const wire::ExerciseState& state) {
  const auto faults_of = [&](const Platform& platform, const wire::PlatformState& its) {
    PoseSettings pose = platform.initial;
    std::vector<FieldError> errors = merge_message(its.pose(), pose);
    append(errors, validate(pose));
    return errors.empty() ? room_.renderer().place(pose) : errors;
  };
  return faults_of_each("platform", room_.radars().platforms(), state.platforms(), name_of, faults_of);
}

void ExercisePlatforms::take(const wire::ExerciseState& state, const std::string& /*by*/) {
  for (Platform& platform : room_.radars().platforms()) {
    platform.pose = platform.initial;
    (void)merge_message(state_of(platform.name, state.platforms(), name_of)->pose(), platform.pose);
  }
}

void ExercisePlatforms::reset(const std::string& name, const std::string& /*by*/) {
  if (!name.empty()) return;
  for (Platform& platform : room_.radars().platforms()) platform.pose = platform.initial;
}

}  // namespace obliq::net
