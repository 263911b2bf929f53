#include "server/apps/commands/fly/fly_targets.h"

#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <utility>

#include "proto/error_number.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/number_option.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/arguments/stream_arguments.h"
#include "server/apps/commands/fly/datagram_inbox.h"
#include "server/apps/commands/fly/fly_datagrams.h"
#include "server/apps/commands/fly/fly_news.h"
#include "server/apps/commands/fly/pdu_source.h"
#include "server/control/config_tree.h"
#include "server/control/sections/targets.h"
#include "server/control/target_message.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFeedLook{10};
constexpr milliseconds kBatchPause{50};
constexpr std::chrono::seconds kCentrePause{1};
constexpr std::chrono::seconds kStatusPause{10};
/// After the last word of it a target goes: IEEE 1278.1-2012, 4.2.8.
constexpr double kValid_s = 12;
constexpr double kMostTimeout_s = 86400;

std::vector<TargetType> own_types(const std::string& file) {
  if (file.empty()) return {};
  return read_type_file(parse_config_file(file));
}

std::vector<TargetType> types_of(const std::optional<wire::TargetList>& known) {
  std::vector<TargetType> types;
  if (known)
    for (const wire::TargetType& type : known->types()) types.push_back(read_message(type));
  return types;
}

/// Not more than the server has room for beside those of the scene, which stay.
std::size_t most_of(const TargetOptions& options, const std::optional<wire::TargetList>& known) {
  if (!known) return options.most;
  const std::uint64_t first_of_dis = target_id({});
  const auto others = static_cast<std::uint64_t>(std::ranges::count_if(
      known->targets(), [&](const wire::Target& target) { return target.id() < first_of_dis; }));
  const std::uint64_t room = known->max_targets();
  return std::min(options.most, room - std::min(room, others));
}

std::optional<wire::TargetList> claim_targets(client::ResumingClient& client, FlyNews& news) {
  require(client.hold("targets", [](client::Client& connected) { return connected.claim_targets(); }));
  wire::TargetList list;
  const client::Status status = client.client().get_targets(list);
  if (status.ok()) return list;
  news.add("the scene's target types are not known: " + status.sentence());
  return std::nullopt;
}

bool is_refusal_of_content(const client::Status& status) {
  return status.outcome == client::Outcome::refused &&
         status.number == static_cast<std::uint32_t>(wire::ErrorNumber::invalid_value);
}

}  // namespace

TargetFeed::TargetFeed(client::ResumingClient& client, FlyNews& news, const DatagramSource& source,
                       std::optional<EntityId> ownship, std::optional<Time> start, std::string radar)
    : TargetFeed(client, news, source, ownship, start, std::move(radar), claim_targets(client, news)) {}

TargetFeed::TargetFeed(client::ResumingClient& client, FlyNews& news, const DatagramSource& source,
                       std::optional<EntityId> ownship, std::optional<Time> start, std::string radar,
                       const std::optional<wire::TargetList>& known)
    : client_(client),
      news_(news),
      heights_{source.undulation_m, source.targets.on_ground},
      start_(start),
      radar_(std::move(radar)),
      has_ownship_(ownship.has_value()),
      kinds_(own_types(source.targets.types_file), types_of(known)),
      table_({ownship, source.targets.timeout_s, source.targets.refresh_hz, most_of(source.targets, known)}) {
}

void TargetFeed::take(const EntityState& state, Time stamped, Time arrived) {
  if (kinds_.of(state.type).type == nullptr) {
    ++none_;
    table_.remove(state.id);
  } else {
    table_.take(state, stamped, arrived);
  }
}

void TargetFeed::find_centre(Time now) {
  if (has_ownship_ || table_.left_out() == 0 || now < next_centre_) return;
  next_centre_ = now + kCentrePause;
  wire::RadarInfo info;
  if (!client_.client().get_radar(radar_, info).ok()) return;
  const wire::Pose& pose = info.pose();
  centre_m_ = location_of({pose.latitude_deg(), pose.longitude_deg(), pose.height_m()});
}

bool TargetFeed::send(Time now) {
  for (std::string& news : kinds_.take_news()) news_.add(std::move(news));
  if (now < next_batch_) return true;
  next_batch_ = now + kBatchPause;
  find_centre(now);
  const EntityTable::Changes changes = table_.changes(now, centre_m_);
  const std::size_t left = table_.left_out();
  if (std::exchange(told_left_, left) == 0 && left > 0)
    news_.add(
        fmt::format("{} entities are left out, those furthest away: there are more than --most or the server "
                    "has room for",
                    left));
  wire::SetTargets change;
  for (const EntityId& id : changes.gone) change.add_gone(target_id(id));
  for (const EntityTable::Moving& entity : changes.set) {
    wire::Target target;
    if (!write_target(entity, kinds_.of(entity.state.type), heights_, target)) {
      ++beyond_;
      continue;
    }
    if (start_) target.set_sim_time_ns(std::chrono::nanoseconds(now - *start_).count());
    target.set_valid_s(kValid_s);
    *change.add_targets() = std::move(target);
  }
  if (send(change)) return true;
  table_.forget_sent();
  return false;
}

bool TargetFeed::send(const wire::SetTargets& change) {
  if (change.targets().empty() && change.gone().empty()) return true;
  std::vector<std::string> warnings;
  const client::Status status = client_.client().set_targets(change, warnings);
  if (is_lost(client_, status)) return false;
  if (!is_refusal_of_content(status)) {
    require(status);
    news_.hear(std::move(warnings));
    sent_ += static_cast<std::uint64_t>(change.targets_size());
    return true;
  }
  if (change.targets_size() <= 1) {
    news_.add("a target is left out: " + status.sentence());
    ++beyond_;
    return true;
  }
  // All or nothing, says the server: by halves, until the one is found that it does not take.
  wire::SetTargets first = change, second;
  const int half = change.targets_size() / 2;
  for (int k = half; k < change.targets_size(); ++k) *second.add_targets() = change.targets(k);
  first.mutable_targets()->DeleteSubrange(half, change.targets_size() - half);
  return send(first) && send(second);
}

std::string TargetFeed::summary() const {
  std::string text = fmt::format("{} {}", table_.size(), table_.size() == 1 ? "entity" : "entities");
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format(", {} {}", count, what);
  };
  add(table_.left_out(), "left out as too many");
  add(none_, "PDUs of entities that no type has");
  add(beyond_, "times outside the limits of a target");
  add(table_.overtaken(), "PDUs overtaken by later ones");
  add(table_.refused(), "PDUs of entities that are more than can be kept");
  return text;
}

void TargetFeed::release() { require(client_.client().release_targets()); }

void FeedStatus::tell(const std::string& text, const std::string& understood, TargetFeed::Time now) {
  if (now < next_ || text == told_) return;
  const bool is_first = std::exchange(told_, text).empty();
  if (is_first) return;  // nothing has come yet
  next_ = now + kStatusPause;
  std::printf("targets: %s, %s\n", text.c_str(), understood.c_str());
  std::fflush(stdout);
}

void add_target_options(CLI::App& command, TargetOptions& options) {
  command.add_flag(
      "--targets", options.wanted,
      "Feed the world's targets from the entities of a DIS exercise, beside the ownship of --dis or "
      "without one");
  command
      .add_option(
          "--types", options.types_file,
          "With --targets: a TOML file of [target_types.NAME] with dis patterns, which come before the "
          "scene's and the shipped ones")
      ->type_name("FILE");
  command
      .add_option("--refresh", options.refresh_hz,
                  "With --targets: those whose dead reckoning is a curve are sent anew at this rate; 0: with "
                  "their PDUs alone")
      ->type_name("HZ")
      ->default_val(options.refresh_hz)
      ->check(number_from(0, 20));
  command
      .add_option("--most", options.most,
                  "With --targets: at most so many, those nearest to the ownship, or to the radar")
      ->type_name("N")
      ->default_val(options.most)
      ->check(whole_number_from(1, 100'000));
  command
      .add_option(
          "--timeout", options.timeout_s,
          "With --targets: an entity goes when no PDU has come for so long; default: 12 s, of one that "
          "stands 144 s")
      ->type_name("SECONDS")
      ->check(number_from(0.1, kMostTimeout_s));
  command.add_flag(
      "--on-ground", options.on_ground,
      "With --targets: vehicles, persons and ships stand on the ground as it is loaded, whatever "
      "height their PDUs say");
}

void feed_targets(client::Client connected, const DatagramSource& source, const std::string& radar,
                  int reconnect_s) {
  TargetFeed* feeding = nullptr;
  client::ResumeOptions resume = reconnecting(reconnect_s);
  resume.give_up = [] { return interrupted(); };
  resume.on_resumed = [&feeding, said = resume.on_resumed](std::chrono::duration<double> after) {
    said(after);
    if (feeding != nullptr) feeding->note_loss();
  };
  client::ResumingClient client(std::move(connected), resume);
  FlyNews news;
  TargetFeed feed(client, news, source, {}, {}, radar);
  feeding = &feed;
  PduSource pdus(source, "targets");
  FeedStatus status;
  const auto text = [&] { return feed.summary() + pdus.losses(); };
  while (!interrupted()) {
    const client::Status received = client.receive(milliseconds(0));
    if (received.outcome != client::Outcome::timed_out) require(received);
    pdus.take(kFeedLook, news, [&](const Pdu& pdu, TargetFeed::Time stamped, TargetFeed::Time arrived) {
      if (const auto* order = std::get_if<SimulationOrder>(&pdu)) feed.obey(*order, arrived);
      if (const auto* state = std::get_if<EntityState>(&pdu)) feed.take(*state, stamped, arrived);
    });
    const auto now = std::chrono::steady_clock::now();
    (void)feed.send(now);  // what is lost is sent again when the connection is back
    status.tell(text(), pdus.understood(), now);
    news.tell_what_is_due();
  }
  news.tell_the_rest();
  std::printf("targets: %s, %llu datagrams that were none, %s\n", text().c_str(),
              static_cast<unsigned long long>(news.refused()), pdus.understood().c_str());
  feed.release();
}

}  // namespace obliq
