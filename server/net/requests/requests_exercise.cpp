// Requests about the whole exercise.
#include <algorithm>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/net/exercise/exercise.h"
#include "server/net/peer.h"
#include "server/net/requests/request_limits.h"
#include "server/net/requests/requests.h"
#include "server/net/rights.h"
#include "server/net/room.h"

namespace obliq::net {

using wire::ErrorNumber;

bool Requests::demand_exercise(const LiveRadar* one) {
  if (peer_.role == security::Role::admin && right_->admin_always) return true;
  return std::ranges::all_of(room_.radars().all(), [&](const LiveRadar& radar) {
    return (one != nullptr && one != &radar) || demand_claims(radar, right_->claims);
  });
}

void Requests::reset_exercise(const wire::ResetExercise& request) {
  const LiveRadar* one = request.radar().empty() ? nullptr : radar_of(request.radar());
  if (one == nullptr && !request.radar().empty()) return;  // refused
  if (!demand_exercise(one)) return;
  room_.exercise().reset(request.radar(), peer_.name);
  acknowledge();
}

void Requests::get_exercise(const wire::GetExercise& request) {
  wire::ExerciseState state;
  room_.targets().expire();
  if (may_have_truth() && !request.without_targets()) {
    room_.exercise().write(state);
  } else {
    state = room_.exercise().for_all();
  }
  state.set_request_id(id_);
  if (const std::size_t bytes = state.ByteSizeLong(); bytes > wire::kMaxDescriptorBytes)
    return refuse({"max_descriptor_bytes",
                   "the exercise is too large for one message: " + std::to_string(room_.targets().n()) +
                       " targets, and some 1,500 fit; without_targets leaves them to GetTargets",
                   {"targets", std::to_string(bytes) + " bytes",
                    "at most " + std::to_string(wire::kMaxDescriptorBytes)}});
  peer_.send(wire::MessageType::exercise_state, state);
}

void Requests::load_exercise(const wire::LoadExercise& request) {
  if (!demand_exercise(nullptr)) return;
  if (request.state().with_targets() && peer_.role != security::Role::admin && !demand_targets()) return;
  const std::vector<FieldError> errors = room_.exercise().load(request.state(), peer_.name);
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "state refused", errors);
  acknowledge();
}

void Requests::set_exercise(const wire::SetExercise& request) {
  if (!demand_exercise(nullptr)) return;
  if (request.has_frozen()) room_.exercise().freeze(request.frozen(), peer_.name);
  acknowledge();
}

}  // namespace obliq::net
