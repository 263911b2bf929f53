#pragma once
#include <optional>
#include <string>
#include <vector>

#include "server/control/sections/radar.h"
#include "server/net/exercise/exercise.h"

namespace obliq::wire {
class RadarState;
}

namespace obliq::net {

struct LiveRadar;

/// Settings with their seeds, poses with their times, switches and limits of all live radars.
class ExerciseRadars : public ExercisePart {
 public:
  explicit ExerciseRadars(Room& room) : room_(room) {}

  void write(wire::ExerciseState& state) const override;
  std::vector<FieldError> faults(const wire::ExerciseState& state) override;
  void take(const wire::ExerciseState& state, const std::string& by) override;
  void reset(const std::string& name, const std::string& by) override;
  void freeze(bool on) override;

 private:
  /// What a radar is to be.
  struct Wanted {
    RadarConfig config;
    bool transmit = true;
    bool frozen = false;
    double rate_limit_hz = 0;
  };
  /// What the state says of a radar; of what it leaves out, what the scene file says.
  static Wanted read(const LiveRadar& radar, const wire::RadarState& state, std::vector<FieldError>& errors);
  std::vector<FieldError> faults_of(const Wanted& wanted) const;
  void put(LiveRadar& radar, const Wanted& wanted, const std::string& by);

  Room& room_;
};

}  // namespace obliq::net
