#pragma once
#include "server/net/exercise/exercise.h"

namespace obliq::net {

/// Where the platforms are. Their radars' own poses follow from it.
class ExercisePlatforms : public ExercisePart {
 public:
  explicit ExercisePlatforms(Room& room) : room_(room) {}

  void write(wire::ExerciseState& state) const override;
  std::vector<FieldError> faults(const wire::ExerciseState& state) override;
  void take(const wire::ExerciseState& state, const std::string& by) override;
  /// Of all alone: a radar that is reset stays on its platform.
  void reset(const std::string& name, const std::string& by) override;
  void freeze(bool /*on*/) override {}

 private:
  Room& room_;
};

}  // namespace obliq::net
