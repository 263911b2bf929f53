#pragma once
#include "server/net/exercise/exercise.h"

namespace obliq::net {

/// The targets of the world, as an exercise has them.
class ExerciseTargets : public ExercisePart {
 public:
  explicit ExerciseTargets(Room& room) : room_(room) {}
  void write(wire::ExerciseState& state) const override;
  std::vector<FieldError> faults(const wire::ExerciseState& state) override;
  void take(const wire::ExerciseState& state, const std::string& by) override;
  /// Of all radars alone: targets are no radar's.
  void reset(const std::string& name, const std::string& by) override;
  void freeze(bool on) override;

 private:
  Room& room_;
};

}  // namespace obliq::net
