#include "server/net/exercise_platforms.h"

#include <algorithm>

#include "proto/obliq.pb.h"
#include "server/control/parameters.h"
#include "server/control/settings_message.h"
#include "server/net/requests.h"
#include "server/net/room.h"

namespace obliq::net {
namespace {

const wire::PlatformState* state_of(const std::string& platform, const wire::ExerciseState& state) {
  const auto at = std::ranges::find(state.platforms(), platform, [](const auto& p) { return p.platform(); });
  return at == state.platforms().end() ? nullptr : &*at;
}

}  // namespace

void ExercisePlatforms::write(wire::ExerciseState& state) const {
  for (const Platform& platform : room_.radars().platforms()) {
    wire::PlatformState& its = *state.add_platforms();
    its.set_platform(platform.name);
    write_message(platform.pose, *its.mutable_pose());
  }
}

std::vector<FieldError> ExercisePlatforms::faults(const wire::ExerciseState& state) {
  std::vector<FieldError> errors;
  const std::deque<Platform>& all = room_.radars().platforms();
  if (state.platforms_size() != static_cast<int>(all.size()))
    errors.push_back({"platforms", std::to_string(state.platforms_size()) + " platforms",
                      std::to_string(all.size()) + ", each of the server's once"});
  for (const Platform& platform : all) {
    const wire::PlatformState* its = state_of(platform.name, state);
    if (its == nullptr) {
      errors.push_back(
          {"platforms", "nothing of " + platform.name, "a state of each platform that is served"});
      continue;
    }
    PoseSettings pose = platform.initial;
    std::vector<FieldError> own = merge_message(its->pose(), pose);
    append(own, validate(pose));
    if (own.empty()) own = room_.renderer().place(pose);
    for (FieldError& error : own) error.field = "platform " + platform.name + ": " + error.field;
    append(errors, std::move(own));
  }
  return errors;
}

void ExercisePlatforms::take(const wire::ExerciseState& state, const std::string& /*by*/) {
  for (Platform& platform : room_.radars().platforms()) {
    platform.pose = platform.initial;
    (void)merge_message(state_of(platform.name, state)->pose(), platform.pose);
  }
}

void ExercisePlatforms::reset(const std::string& name, const std::string& /*by*/) {
  if (!name.empty()) return;
  for (Platform& platform : room_.radars().platforms()) platform.pose = platform.initial;
}

}  // namespace obliq::net
