#include "server/net/exercise/exercise_log.h"

#include <google/protobuf/util/message_differencer.h>

#include <algorithm>
#include <utility>

#include "proto/message_header.h"
#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/net/live_radar.h"

namespace obliq::net {
namespace {

/// What a field is changed by without its own name: a change of the one goes with the value of the other.
struct Companion {
  const char* field;
  const char* other;
};
constexpr Companion kCompanions[] = {{"video_floor_db", "video_floor_auto"}, {"sea_state", "sea_state_auto"}};

/// Of `now`, what is not as it was before, and what belongs to it.
wire::RadarSettings changes(const wire::RadarSettings& before, const wire::RadarSettings& now) {
  wire::RadarSettings changed = now;
  const google::protobuf::Reflection& of = *now.GetReflection();
  const google::protobuf::Descriptor& all = *now.GetDescriptor();
  for (int i = 0; i < all.field_count(); ++i) {
    const google::protobuf::FieldDescriptor* field = all.field(i);
    google::protobuf::util::MessageDifferencer difference;
    if (of.HasField(now, field) && difference.CompareWithFields(before, now, {field}, {field}))
      of.ClearField(&changed, field);
  }
  for (const auto& [name, other] : kCompanions) {
    const auto* field = all.FindFieldByName(name);
    const auto* beside = all.FindFieldByName(other);
    if (of.HasField(changed, field)) of.SetBool(&changed, beside, of.GetBool(now, beside));
  }
  return changed;
}

bool is_empty(const google::protobuf::Message& message) { return message.ByteSizeLong() == 0; }

wire::ExerciseEvent event_of(wire::EventKind kind, const std::string& radar, const std::string& by) {
  wire::ExerciseEvent event;
  event.set_kind(kind);
  event.set_radar(radar);
  event.set_by(by);
  return event;
}

wire::ExerciseEvent event_of(wire::EventKind kind, const LiveRadar& radar, const std::string& by) {
  wire::ExerciseEvent event = event_of(kind, radar.name, by);
  if (radar.pose_has_sim_time) event.set_sim_time_ns(radar.pose.sim_time_ns);
  return event;
}

wire::ExerciseEvent event_of_claim(wire::EventKind kind, const LiveRadar* radar, wire::ClaimSet claims,
                                   const std::string& by) {
  wire::ExerciseEvent event =
      radar == nullptr ? event_of(kind, std::string(), by) : event_of(kind, *radar, by);
  wire::for_each_claim(claims,
                       [&](wire::Claim claim) { event.add_claims(static_cast<wire::ClaimKind>(claim)); });
  return event;
}

}  // namespace

struct ExerciseLog::Kept {
  wire::ExerciseEvent event;
  std::size_t bytes = 0;
};

std::uint64_t ExerciseLog::number_of(const std::unique_ptr<const Kept>& kept) { return kept->event.number(); }

ExerciseLog::ExerciseLog() = default;
ExerciseLog::~ExerciseLog() = default;

void ExerciseLog::note(wire::ExerciseEvent event) {
  event.set_number(++newest_);
  if (event.utc_ns() == 0) event.set_utc_ns(wire::utc_now_ns());
  if (listener_) listener_(event);
  const std::size_t bytes = event.ByteSizeLong();
  Events& same_kind = event.kind() == wire::BOOKMARK_EVENT  ? bookmarks_
                      : event.kind() == wire::TARGETS_EVENT ? targets_
                                                            : others_;
  same_kind.push_back(std::make_unique<const Kept>(Kept{std::move(event), bytes}));
  if (&same_kind == &others_) bytes_ += bytes;
  while (targets_.size() > kMostTargetEvents) drop_oldest(targets_);
  while (others_.size() > kMostEvents || (bytes_ > kMostBytes && others_.size() > 1)) drop_oldest(others_);
}

void ExerciseLog::drop_oldest(Events& kept) {
  if (&kept == &others_) bytes_ -= kept.front()->bytes;
  kept.pop_front();
  ++lost_;
}

void ExerciseLog::claimed(const LiveRadar* radar, wire::ClaimSet claims, const std::string& by) {
  wire::ExerciseEvent event = event_of_claim(wire::CLAIM_EVENT, radar, claims, by);
  note(std::move(event));
}

void ExerciseLog::released(const LiveRadar* radar, wire::ClaimSet claims, const std::string& by) {
  wire::ExerciseEvent event = event_of_claim(wire::RELEASE_EVENT, radar, claims, by);
  note(std::move(event));
}

void ExerciseLog::taken_over(const LiveRadar* radar, wire::ClaimSet claims, const std::string& from,
                             const std::string& by) {
  wire::ExerciseEvent event = event_of_claim(wire::TAKE_OVER_EVENT, radar, claims, by);
  event.set_taken_from(from);
  note(std::move(event));
}

void ExerciseLog::set(const LiveRadar& radar, const RadarSettings& before, const std::string& by) {
  wire::ExerciseEvent event = event_of(wire::SETTINGS_EVENT, radar, by);
  wire::RadarSettings was;
  wire::RadarSettings is;
  write_request(before, was);
  write_request(radar.settings.current()->settings, is);
  *event.mutable_settings() = changes(was, is);
  if (!is_empty(event.settings())) note(std::move(event));
}

void ExerciseLog::aimed(const LiveRadar& radar, const PoseSettings& before, const wire::Pose& asked,
                        const std::string& by) {
  if (radar.pose == before) return;
  wire::ExerciseEvent event = event_of(wire::AIM_EVENT, radar, by);
  *event.mutable_pose() = asked;
  note(std::move(event));
}

ExerciseLog::Switches ExerciseLog::switches_of(const LiveRadar& radar) {
  return {radar.transmit, radar.frozen, radar.rate_limit_hz};
}

void ExerciseLog::switched(const LiveRadar& radar, const Switches& before, const std::string& by) {
  const Switches now = switches_of(radar);
  wire::ExerciseEvent event = event_of(wire::SWITCH_EVENT, radar, by);
  if (now.transmit != before.transmit) event.set_transmit(now.transmit);
  if (now.frozen != before.frozen) event.set_freeze(now.frozen);
  if (now.rate_limit_hz != before.rate_limit_hz) event.set_rate_limit_hz(now.rate_limit_hz);
  if (event.has_transmit() || event.has_freeze() || event.has_rate_limit_hz()) note(std::move(event));
}

void ExerciseLog::reset(const std::string& radar, const wire::ExerciseState& state, const std::string& by) {
  wire::ExerciseEvent event = event_of(wire::RESET_EVENT, radar, by);
  *event.mutable_state() = state;
  note(std::move(event));
}

void ExerciseLog::loaded(const wire::ExerciseState& state, const std::string& by) {
  wire::ExerciseEvent event = event_of(wire::LOAD_EVENT, "", by);
  *event.mutable_state() = state;
  note(std::move(event));
}

void ExerciseLog::froze(bool on, const std::string& by) {
  wire::ExerciseEvent event = event_of(wire::FREEZE_EVENT, "", by);
  event.set_freeze(on);
  note(std::move(event));
}

void ExerciseLog::targets(std::uint32_t come, std::uint32_t gone, const std::string& by) {
  wire::ExerciseEvent event = event_of(wire::TARGETS_EVENT, "", by);
  event.set_targets_come(come);
  event.set_targets_gone(gone);
  note(std::move(event));
}

bool ExerciseLog::write(std::uint64_t after, wire::ExerciseEvents& events) const {
  events.set_lost(lost_);
  std::uint64_t last = after;
  std::size_t bytes = 0;
  while (const Kept* next = first_behind(last)) {
    if (events.events_size() > 0 && bytes + next->bytes > kPageBytes) return false;
    *events.add_events() = next->event;
    bytes += next->bytes;
    last = next->event.number();
  }
  return true;
}

const ExerciseLog::Kept* ExerciseLog::first_behind(std::uint64_t number) const {
  const Kept* first = nullptr;
  for (const Events* kept : {&bookmarks_, &targets_, &others_}) {
    const auto at = std::ranges::upper_bound(*kept, number, {}, number_of);
    if (at != kept->end() && (first == nullptr || number_of(*at) < first->event.number())) first = at->get();
  }
  return first;
}

const wire::ExerciseEvent* ExerciseLog::find(std::uint64_t number) const {
  const Kept* found = number == 0 ? nullptr : first_behind(number - 1);
  return found != nullptr && found->event.number() == number ? &found->event : nullptr;
}

}  // namespace obliq::net
