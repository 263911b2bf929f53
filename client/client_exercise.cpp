// What a client asks about a whole exercise, its log, and a replay of it.
#include "client/frame_dispatch.h"
#include "proto/bookmark.h"
#include "proto/obliq.pb.h"
// After the messages:
#include "client/client_state.h"

namespace obliq::client {

using wire::MessageType;

Status Client::State::hand_on_events(const Message& message) {
  wire::ExerciseEvents events;
  if (!wire::parse_descriptor(message.descriptor(), events)) return unreadable("ExerciseEvents");
  return handler != nullptr && events.request_id() == 0 ? handler->on_events(events) : Status{};
}

Status Client::State::demand_1_2() const {
  if (!connection.is_open()) return Status::failure(Outcome::closed, "not connected");
  if (welcome.minor() >= 2) return {};
  return Status::failure(Outcome::bad_argument, "the server speaks version 1." +
                                                    std::to_string(welcome.minor()) +
                                                    " of the protocol; allowed: 1.2 or later");
}

Status Client::get_exercise(wire::ExerciseState& state) {
  wire::GetExercise request;
  return state_->call(MessageType::get_exercise, request, MessageType::exercise_state, state);
}

Status Client::load_exercise(const wire::ExerciseState& state) {
  wire::LoadExercise request;
  *request.mutable_state() = state;
  return state_->acknowledged(MessageType::load_exercise, request);
}

Status Client::reset_exercise(const std::string& radar) {
  auto request = about<wire::ResetExercise>(radar);
  return state_->acknowledged(MessageType::reset_exercise, request);
}

Status Client::freeze_exercise(bool on) {
  wire::SetExercise request;
  request.set_frozen(on);
  return state_->acknowledged(MessageType::set_exercise, request);
}

Status Client::get_events(std::uint64_t after, bool follow, wire::ExerciseEvents& events, bool with_state) {
  // A server of before skips the request, and nothing would come.
  if (Status status = state_->demand_1_2(); !status.ok()) return status;
  wire::GetEvents request;
  request.set_after(after);
  request.set_follow(follow);
  request.set_with_state(with_state);
  return state_->call(MessageType::get_events, request, MessageType::exercise_events, events);
}

Status Client::add_bookmark(const std::string& text) {
  if (Status status = state_->demand_1_2(); !status.ok()) return status;
  if (const auto fault = wire::bookmark_fault(text))
    return Status::failure(Outcome::bad_argument,
                           "text: found " + fault->found + "; allowed: " + fault->allowed);
  wire::AddBookmark request;
  request.set_text(text);
  return state_->acknowledged(MessageType::add_bookmark, request);
}

Status Client::set_replay(wire::SetReplay& request) {
  return state_->acknowledged(MessageType::set_replay, request);
}
const wire::ReplayState* Client::replay_state() const {
  return state_->replay_state ? &*state_->replay_state : nullptr;
}

}  // namespace obliq::client
