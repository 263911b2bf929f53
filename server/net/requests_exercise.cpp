// Requests about the whole exercise.
#include "proto/obliq.pb.h"
#include "server/net/exercise.h"
#include "server/net/peer.h"
#include "server/net/requests.h"
#include "server/net/rights.h"
#include "server/net/room.h"

namespace obliq::net {

using wire::ErrorNumber;

bool Requests::demand_all_claims() {
  if (peer_.role == Role::admin && right_->admin_always) return true;
  for (const LiveRadar& radar : room_.radars().all())
    if (!demand_claims(radar, right_->claims)) return false;
  return true;
}

void Requests::reset_exercise(const wire::ResetExercise& request) {
  const bool all = request.radar().empty();
  const LiveRadar* radar = all ? nullptr : radar_of(request.radar());
  if (!all && radar == nullptr) return;
  const bool may = peer_.role == Role::admin && right_->admin_always;
  if (!may && !(all ? demand_all_claims() : demand_claims(*radar, right_->claims))) return;
  room_.exercise().reset(request.radar(), peer_.name);
  acknowledge();
}

void Requests::get_exercise(const wire::GetExercise& /*request*/) {
  wire::ExerciseState state;
  state.set_request_id(id_);
  room_.exercise().write(state);
  peer_.send(wire::MessageType::exercise_state, state);
}

void Requests::load_exercise(const wire::LoadExercise& request) {
  if (!demand_all_claims()) return;
  const std::vector<FieldError> errors = room_.exercise().load(request.state(), peer_.name);
  if (!errors.empty()) return refuse(ErrorNumber::invalid_value, "state refused", errors);
  acknowledge();
}

void Requests::set_exercise(const wire::SetExercise& request) {
  if (!demand_all_claims()) return;
  if (request.has_frozen()) room_.exercise().freeze(request.frozen(), peer_.name);
  acknowledge();
}

}  // namespace obliq::net
