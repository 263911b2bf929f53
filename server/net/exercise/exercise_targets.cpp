#include "server/net/exercise/exercise_targets.h"

#include "server/net/room.h"

namespace obliq::net {

void ExerciseTargets::write(wire::ExerciseState& state) const { room_.targets().write(state); }

std::vector<FieldError> ExerciseTargets::faults(const wire::ExerciseState& state) {
  return room_.targets().faults(state);
}

void ExerciseTargets::take(const wire::ExerciseState& state, const std::string& /*by*/) {
  room_.targets().take(state);
}

void ExerciseTargets::reset(const std::string& name, const std::string& /*by*/) {
  if (name.empty()) room_.targets().reset();
}

void ExerciseTargets::freeze(bool on) { room_.targets().freeze(on); }

}  // namespace obliq::net
