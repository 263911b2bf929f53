// Requests about the log of the exercise, and bookmarks in it.
#include <fmt/core.h>

#include <algorithm>

#include "proto/bookmark.h"
#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/net/peer.h"
#include "server/net/requests/request_limits.h"
#include "server/net/requests/requests.h"
#include "server/net/room.h"
#include "server/rendering/replay_control.h"

namespace obliq::net {

using wire::ErrorNumber;

namespace {

/// Of an ExerciseEvents, beside its events and its state.
constexpr std::size_t kSlack_bytes = 64;

}  // namespace

void Requests::get_events(const wire::GetEvents& request) {
  wire::ExerciseEvents answer;
  answer.set_request_id(id_);
  const bool all = room_.log().write(request.after(), answer);
  wire::ExerciseState state;
  const bool with_state = all && request.with_state() && room_.replay() == nullptr;
  if (with_state) state = room_.exercise().for_all();
  // Both are large where many radars were loaded or reset: then the state has a message of its own.
  const bool too_much =
      answer.ByteSizeLong() + state.ByteSizeLong() + kSlack_bytes > wire::kMaxDescriptorBytes;
  const bool ends = all && !(with_state && answer.events_size() > 0 && too_much);
  answer.set_more(!ends);
  if (ends && with_state) {
    *answer.mutable_state() = std::move(state);
    answer.set_frozen(room_.exercise().is_frozen());
  }
  if (ends) peer_.follows_events = request.follow();
  peer_.send(wire::MessageType::exercise_events, answer);
}

void Requests::add_bookmark(const wire::AddBookmark& request) {
  if (const auto fault = wire::bookmark_fault(request.text()))
    return refuse(ErrorNumber::invalid_value, "bookmark refused", {{"text", fault->found, fault->allowed}});
  if (room_.log().bookmarks() >= ExerciseLog::kMostBookmarks)
    return refuse(
        {"bookmarks",
         fmt::format("bookmarks: this server has {} and takes no more", ExerciseLog::kMostBookmarks),
         {"text", fmt::format("bookmark {}", room_.log().bookmarks() + 1),
          fmt::format("{} bookmarks of one server", ExerciseLog::kMostBookmarks)}});
  wire::ExerciseEvent event;
  event.set_kind(wire::BOOKMARK_EVENT);
  event.set_by(peer_.name);
  event.set_text(request.text());
  if (room_.replay() != nullptr) {
    wire::ReplayState state;
    room_.replay()->write_state(state);
    event.set_utc_ns(state.start_utc_ns() + static_cast<std::int64_t>(1e9 * state.position_s()));
    if (state.has_sim_time_ns()) event.set_sim_time_ns(state.sim_time_ns());
  } else if (const LiveRadar& first = room_.radars().all().front(); first.pose_has_sim_time) {
    event.set_sim_time_ns(first.pose.sim_time_ns);
  }
  if (room_.replay() != nullptr) room_.replay()->keep(event);
  room_.log().note(std::move(event));
  acknowledge();
}

std::vector<FieldError> Requests::find_bookmark(wire::SetReplay& request) {
  if (!request.has_seek_bookmark()) return {};
  const std::string found = std::to_string(request.seek_bookmark());
  if (request.has_seek_s() || request.has_seek_sim_time_ns())
    return {
        {"seek_bookmark", found + " beside another place", "one of seek_s, seek_sim_time_ns, seek_bookmark"}};
  const wire::ExerciseEvent* event = room_.log().find(request.seek_bookmark());
  if (event == nullptr) return {{"seek_bookmark", found, "the number of an event, as GetEvents lists them"}};
  wire::ReplayState state;
  room_.replay()->write_state(state);
  const double place_s = 1e-9 * static_cast<double>(event->utc_ns() - state.start_utc_ns());
  request.clear_seek_bookmark();
  request.set_seek_s(std::clamp(place_s, 0.0, state.duration_s()));
  return {};
}

}  // namespace obliq::net
