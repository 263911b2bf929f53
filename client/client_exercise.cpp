// What a client asks about a whole exercise, its log, and a replay of it.
#include <utility>

#include "client/frame_dispatch.h"
#include "proto/bookmark.h"
#include "proto/error_number.h"
#include "proto/limits.h"
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

namespace {

/// The request around a state.
constexpr std::size_t kSlackBytes = 64;

}  // namespace

Status Client::get_exercise(wire::ExerciseState& state) {
  wire::GetExercise request;
  const Status whole = state_->call(MessageType::get_exercise, request, MessageType::exercise_state, state);
  if (whole.number != static_cast<std::uint32_t>(wire::ErrorNumber::over_limit)) return whole;
  // More targets than one message holds.
  request.set_without_targets(true);
  Status status = state_->call(MessageType::get_exercise, request, MessageType::exercise_state, state);
  wire::TargetList list;
  if (status.ok()) status = get_targets(list);
  if (!status.ok()) return status;
  *state.mutable_targets() = std::move(*list.mutable_targets());
  state.set_with_targets(true);
  return {};
}

Status Client::load_exercise(const wire::ExerciseState& state) {
  wire::LoadExercise request;
  *request.mutable_state() = state;
  const bool fits = request.ByteSizeLong() + kSlackBytes <= wire::kMaxDescriptorBytes;
  if (fits || !state.with_targets()) return state_->acknowledged(MessageType::load_exercise, request);
  request.mutable_state()->clear_targets();
  request.mutable_state()->set_with_targets(false);
  if (Status status = claim_targets(); !status.ok()) return status;
  if (Status status = state_->acknowledged(MessageType::load_exercise, request); !status.ok()) return status;
  wire::SetTargets change;
  change.set_clear(true);
  *change.mutable_targets() = state.targets();
  std::vector<std::string> warnings;
  Status status = set_targets(change, warnings);
  if (!status.ok())
    status.text = "the radars are as the state says, the targets as they were: " + status.text;
  return status;
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
