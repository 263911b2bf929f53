#include "server/net/target_world.h"

#include <algorithm>
#include <glm/common.hpp>
#include <set>
#include <utility>

#include "proto/limits.h"
#include "proto/obliq.pb.h"
#include "server/control/key.h"
#include "server/control/target_message.h"
#include "server/log/log.h"
#include "server/net/exercise/exercise_log.h"
#include "server/net/peer.h"
#include "server/net/requests/requests.h"
#include "server/radar/targets/target_motion.h"
#include "server/rendering/render_thread.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {
namespace {

/// Of the targets in one message.
constexpr std::size_t kPageBytes = std::size_t{200} << 10;
/// Of a request of several messages.
constexpr std::size_t kMostStagedBytes = std::size_t{16} << 20;
/// Of all targets' routes.
constexpr std::size_t kMostPointsInAll = 100'000;
/// Of ids in one request: ten worlds.
constexpr std::size_t kMostGone = 100'000;
/// In one refusal.
constexpr std::size_t kMostErrors = 20;
constexpr double kLongest_s = 1e8;

FieldError in_target(std::size_t index, FieldError error) {
  error.field = "targets[" + std::to_string(index) + "]." + error.field;
  return error;
}

template <typename Message>
std::vector<const wire::Target*> all_of(const Message& message) {
  std::vector<const wire::Target*> all;
  for (const wire::Target& target : message.targets()) all.push_back(&target);
  return all;
}

std::int64_t before(std::int64_t now_ns, double age_s) {
  return now_ns - static_cast<std::int64_t>(1e9 * age_s);
}

}  // namespace

struct TargetWorld::Staged {
  wire::SetTargets request;
  Amount amount;
};

TargetWorld::TargetWorld(const ServerOptions& options, rendering::RenderThread& render, ExerciseLog& log,
                         Post post)
    : options_(options), render_(render), log_(log), post_(std::move(post)) {
  begin();
  ++version_;
  is_published_ = false;
  publish();  // not posted: the io thread may run already
}

TargetWorld::~TargetWorld() = default;

std::int64_t TargetWorld::now_ns() const { return frozen_since_ns_.value_or(stream::monotonic_ns()); }

void TargetWorld::claim(Peer& by) {
  Peer* holder = claims_.holder(wire::Claim::targets);
  if (holder == &by) return;
  if (holder != nullptr) {
    claims_.release(wire::kTargetsClaim, *holder);
    staged_ = nullptr;
    log_.taken_over(nullptr, wire::kTargetsClaim, holder->name, by.name);
    log_as_guest(*holder);
    holder->send(wire::MessageType::error,
                 make_error(0, wire::ErrorNumber::controlled_by_other, "targets: taken over by " + by.name));
    log_warning("targets: {} takes them from {}; give it a token of another role if it should not", by.name,
                holder->name);
  } else {
    log_.claimed(nullptr, wire::kTargetsClaim, by.name);
  }
  log_as_guest(by);
  log_doing(by, "targets", "claimed by " + by.name);
  claims_.give(wire::kTargetsClaim, by);
}

bool TargetWorld::release(const Peer& peer, const std::string& why) {
  if (claims_.release(wire::kTargetsClaim, peer) == 0) return false;
  staged_ = nullptr;
  log_.released(nullptr, wire::kTargetsClaim, peer.name);
  log_doing(peer, "targets", "released" + why);
  return true;
}

void TargetWorld::forget(const Peer& peer) { release(peer, ", " + peer.name + " has left"); }

void TargetWorld::check_role(Peer& peer) {
  if (peer.role >= security::Role::controller) return;
  if (!release(peer,
               ", the role of " + peer.name + " is " + std::string(security::role_name(peer.role)) + " now"))
    return;
  peer.send(wire::MessageType::error,
            make_error(0, wire::ErrorNumber::role_too_low,
                       "setting targets needs the role controller; this client's token gives " +
                           std::string(security::role_name(peer.role)) + " now"));
}

Target TargetWorld::begin_anew(const wire::Target& message, const Target& was, bool is_new) const {
  const bool is_timed = message.has_sim_time_ns();
  const std::int64_t arrived_ns = before(now_ns(), message.age_s());
  Target is = was;
  // Where it has come meanwhile, as far as the message does not say; a new route begins where it stands.
  if (!is_new) {
    const double since_s = is_timed && was.is_timed ? seconds_between(was.sim_time_ns, message.sim_time_ns())
                                                    : seconds_between(was.arrived_ns, arrived_ns);
    if (const auto there = brought_to(was, since_s)) is = *there;
    // However far it has come, it is somewhere that a target may be.
    is.height_m = std::clamp(is.height_m, kLeastTargetHeight_m, kMostTargetHeight_m);
    is.velocity_m_s = glm::clamp(is.velocity_m_s, -kMostSpeed_m_s, kMostSpeed_m_s);
  }
  is.is_timed = is_timed;
  if (is_timed) is.sim_time_ns = message.sim_time_ns();
  is.arrived_ns = arrived_ns;
  return is;
}

std::vector<FieldError> TargetWorld::merge(const wire::Target& message, const TargetConfig* was,
                                           TargetConfig& is) const {
  std::vector<FieldError> errors;
  const auto within = [&](const char* field, double value, double most) {
    if (!(value >= 0 && value <= most))
      errors.push_back({field, toml_number(value), "0 to " + toml_number(most) + " s"});
  };
  within("age_s", message.age_s(), kLongest_s);
  within("valid_s", message.valid_s(), kLongest_s);
  if (message.id() == 0) errors.push_back({"id", "0", "a number from 1"});
  if (message.has_sim_time_ns() && message.has_age_s())
    errors.push_back({"age_s", "one, and sim_time_ns", "one of the two"});
  constexpr std::int64_t kMostSimTime_ns = 4'000'000'000'000'000'000;
  if (message.sim_time_ns() < -kMostSimTime_ns || message.sim_time_ns() > kMostSimTime_ns)
    errors.push_back({"sim_time_ns", std::to_string(message.sim_time_ns()), "-4e18 to 4e18 ns"});
  if (was == nullptr && (!message.has_latitude_deg() || !message.has_longitude_deg()))
    errors.push_back({message.has_latitude_deg() ? "longitude_deg" : "latitude_deg", "nothing",
                      "a value: a new target is somewhere"});
  if (!errors.empty()) return errors;

  is = was == nullptr ? TargetConfig{} : *was;
  is.target.id = message.id();
  // A route goes on, and its times with it, unless the message ends it.
  const bool turns = message.has_heading_deg() || message.has_heading_rate_deg_s() ||
                     message.has_sim_time_ns() || message.has_age_s();
  if (was == nullptr || says_motion(message) || (!is.target.route && turns))
    is.target = begin_anew(message, is.target, was == nullptr);
  // A word on its validity alone renews it.
  if (message.has_valid_s()) {
    is.target.valid_s = message.valid_s();
    if (is.target.is_timed) is.target.arrived_ns = now_ns();
  }
  return merge_message(message, options_.target_types, is);
}

std::vector<FieldError> TargetWorld::read(const Messages& messages, const All& all, Change& change) const {
  std::vector<FieldError> errors;
  for (std::size_t k = 0; k < messages.size() && errors.size() < kMostErrors; ++k) {
    const wire::Target& message = *messages[k];
    const std::uint64_t id = message.id();
    if (change.set.contains(id)) {
      errors.push_back(in_target(k, {"id", std::to_string(id) + " again", "each id once in a request"}));
      continue;
    }
    const auto known = all.find(id);
    const TargetConfig* was = known == all.end() || change.gone.contains(id) ? nullptr : &known->second;
    if (was != nullptr && message.has_sim_time_ns() && was->target.is_timed &&
        message.sim_time_ns() < was->target.sim_time_ns) {
      ++change.late;
      continue;
    }
    for (FieldError& error : merge(message, was, change.set[id]))
      if (errors.size() < kMostErrors) errors.push_back(in_target(k, std::move(error)));
  }
  return errors;
}

std::vector<FieldError> TargetWorld::oversize(const Amount& amount, const std::string& where) const {
  const auto at_most = [&](std::size_t most) { return "at most " + std::to_string(most) + " in " + where; };
  if (const auto most = static_cast<std::size_t>(options_.max_targets); amount.targets > most)
    return {{"targets", std::to_string(amount.targets), at_most(most)}};
  if (amount.gone > kMostGone) return {{"gone", std::to_string(amount.gone), at_most(kMostGone)}};
  if (amount.points > kMostPointsInAll)
    return {{"targets", std::to_string(amount.points) + " points of routes", at_most(kMostPointsInAll)}};
  if (amount.bytes > kMostStagedBytes)
    return {{"more", "over " + std::to_string(kMostStagedBytes >> 20) + " MiB in one request", "less"}};
  return {};
}

TargetWorld::Outcome TargetWorld::set(const wire::SetTargets& request, const std::string& by) {
  // By what the message itself says, before any of it is worked on.
  Amount amount = staged_ ? staged_->amount : Amount{};
  amount.targets += static_cast<std::size_t>(request.targets_size());
  amount.gone += static_cast<std::size_t>(request.gone_size());
  for (const wire::Target& target : request.targets())
    amount.points += static_cast<std::size_t>(target.route().latitude_deg_size());
  amount.bytes += request.ByteSizeLong();
  if (auto over = oversize(amount, "a request"); !over.empty()) {
    staged_ = nullptr;
    return {std::move(over), true, {}};
  }
  if (!staged_ && !request.more()) return commit(request, by);
  if (!staged_) staged_ = std::make_unique<Staged>();
  staged_->request.MergeFrom(request);
  staged_->amount = amount;
  if (request.more()) return {};
  const auto whole = std::exchange(staged_, nullptr);
  return commit(whole->request, by);
}

std::vector<FieldError> TargetWorld::too_much(const wire::SetTargets& request, const Change& change) const {
  Amount amount;
  const auto add = [&](const TargetConfig& target) {
    ++amount.targets;
    amount.points += target.route.points.size();
  };
  for (const auto& [id, target] : change.set) add(target);
  const bool has_routes = amount.points > 0;
  if (!request.clear())
    for (const auto& [id, target] : all_)
      if (!change.set.contains(id) && !change.gone.contains(id)) add(target);
  if (!has_routes) amount.points = 0;  // those that are there already
  return oversize(amount, "the world");
}

TargetWorld::Outcome TargetWorld::commit(const wire::SetTargets& request, const std::string& by) {
  expire();
  Change change;
  Outcome outcome;
  for (int k = 0; k < request.gone_size() && outcome.errors.size() < kMostErrors; ++k)
    if (!change.gone.insert(request.gone(k)).second)
      outcome.errors.push_back({"gone[" + std::to_string(k) + "]", std::to_string(request.gone(k)) + " again",
                                "each id once in a request"});
  static const All kNone;
  append(outcome.errors, read(all_of(request), request.clear() ? kNone : all_, change));
  if (!outcome.errors.empty()) return outcome;
  outcome.errors = too_much(request, change);
  outcome.too_many = !outcome.errors.empty();
  if (outcome.too_many) return outcome;

  late_ += change.late;
  if (change.late > 0)
    outcome.warnings.push_back(std::to_string(change.late) +
                               " late: their sim_time_ns is before the newest of their target; left out");
  std::uint32_t come = 0, gone = 0;
  for (const auto& [id, target] : change.set) come += all_.contains(id) ? 0U : 1U;
  if (request.clear()) {
    for (const auto& [id, target] : all_) gone += change.set.contains(id) ? 0U : 1U;
    all_.clear();
  }
  for (const std::uint64_t id : change.gone)
    if (all_.erase(id) > 0 && !change.set.contains(id)) ++gone;
  for (auto& [id, target] : change.set) all_.insert_or_assign(id, std::move(target));
  changed();
  if (come > 0 || gone > 0) log_.targets(come, gone, by);
  return outcome;
}

std::vector<FieldError> TargetWorld::read_anew(const Messages& messages, Change& change) const {
  if (auto over = oversize({.targets = messages.size()}, "a request"); !over.empty()) return over;
  return read(messages, {}, change);
}

std::vector<FieldError> TargetWorld::read(const wire::RenderOnce& request,
                                          std::vector<Target>& targets) const {
  Change change;
  std::vector<FieldError> errors = read_anew(all_of(request), change);
  for (auto& [id, target] : change.set) targets.push_back(std::move(target.target));
  return errors;
}

TargetsPtr TargetWorld::of_one_frame(const std::vector<Target>& own, bool live) {
  publish();
  if (own.empty()) return live ? published_ : nullptr;
  auto set = std::make_shared<TargetSet>();
  set->seed = options_.target_seed;
  if (live) set->version = version_;
  set->targets = own;
  for (const auto& [id, target] : all_)
    if (live && !std::ranges::binary_search(own, id, {}, &Target::id)) set->targets.push_back(target.target);
  std::ranges::sort(set->targets, {}, &Target::id);
  return set;
}

wire::Target TargetWorld::message_of(const TargetConfig& target) const {
  wire::Target message;
  write_message(target, message);
  const Target& its = target.target;
  if (its.is_timed) {
    message.set_sim_time_ns(its.sim_time_ns);
  } else {
    message.set_age_s(std::clamp(seconds_between(its.arrived_ns, now_ns()), 0.0, kLongest_s));
  }
  message.set_valid_s(its.valid_s);
  return message;
}

void TargetWorld::write(std::uint64_t after, wire::TargetList& list) const {
  list.set_version(version_);
  if (const Peer* holder = claims_.holder(wire::Claim::targets)) list.set_controller(holder->name);
  list.set_max_targets(static_cast<std::uint32_t>(options_.max_targets));
  list.set_expired(expired_);
  list.set_late(late_);
  if (after == 0)
    for (const TargetType& type : options_.target_types) write_message(type, *list.add_types());
  std::size_t bytes = list.ByteSizeLong();
  for (auto at = all_.upper_bound(after); at != all_.end(); ++at) {
    wire::Target message = message_of(at->second);
    bytes += message.ByteSizeLong() + 8;
    if (bytes > kPageBytes && list.targets_size() > 0) return list.set_more(true);
    *list.add_targets() = std::move(message);
  }
}

void TargetWorld::expire() {
  const std::int64_t now = now_ns();
  const auto gone = std::erase_if(all_, [&](const auto& entry) {
    const Target& its = entry.second.target;
    return its.valid_s > 0 && seconds_between(its.arrived_ns, now) > its.valid_s;
  });
  if (gone == 0) return;
  expired_ += gone;
  log_.targets(0, static_cast<std::uint32_t>(gone), "the end of their validity");
  changed();
}

void TargetWorld::changed() {
  ++version_;
  if (!std::exchange(is_published_, false)) return;
  post_([this] { publish(); });
}

void TargetWorld::publish() {
  if (std::exchange(is_published_, true)) return;
  auto set = std::make_shared<TargetSet>();
  set->seed = options_.target_seed;
  set->version = version_;
  set->targets.reserve(all_.size());
  for (const auto& [id, target] : all_) set->targets.push_back(target.target);
  published_ = all_.empty() ? nullptr : std::move(set);
  render_.set_targets(published_);
}

void TargetWorld::begin() {
  all_.clear();
  for (TargetConfig target : options_.targets) {
    target.target.arrived_ns = now_ns();
    target.lay_route();
    all_.emplace(target.target.id, std::move(target));
  }
}

void TargetWorld::reset() {
  begin();
  changed();
}

void TargetWorld::write(wire::ExerciseState& state) const {
  state.set_with_targets(true);
  for (const auto& [id, target] : all_) *state.add_targets() = message_of(target);
}

std::vector<FieldError> TargetWorld::faults(const wire::ExerciseState& state) const {
  if (!state.with_targets()) return {};
  Change none;
  return read_anew(all_of(state), none);
}

void TargetWorld::take(const wire::ExerciseState& state) {
  if (!state.with_targets()) return;
  Change change;
  (void)read_anew(all_of(state), change);
  all_ = std::move(change.set);
  changed();
}

void TargetWorld::freeze(bool on) {
  if (on == frozen_since_ns_.has_value()) return;
  if (on) {
    frozen_since_ns_ = stream::monotonic_ns();
    return;
  }
  const std::int64_t pause_ns = stream::monotonic_ns() - *frozen_since_ns_;
  frozen_since_ns_.reset();
  for (auto& [id, target] : all_) target.target.arrived_ns += pause_ns;
  changed();
}

}  // namespace obliq::net
