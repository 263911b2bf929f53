#include "server/net/room.h"

#include <algorithm>
#include <utility>

#include "proto/ground_record.h"
#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"
#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/net/requests/requests.h"
#include "server/rendering/replay_control.h"
#include "server/security/networks.h"
#include "server/security/security.h"
#include "terrain/base/memory_limit.h"
#include "terrain/base/process.h"

namespace obliq::net {

using wire::ErrorNumber;
using wire::MessageType;

Room::Room(const rendering::FrameRenderer& renderer, ServerOptions options,
           const std::vector<RadarConfig>& radars, Post post)
    : renderer_(renderer),
      options_(std::move(options)),
      post_(std::move(post)),
      last_stream_id_(static_cast<std::uint32_t>(radars.size())),
      render_(renderer, *this,
              {.threads = options_.render_threads,
               .slice_bytes = options_.slice_bytes,
               .live_frames = options_.live_frames}),
      radars_(options_, radars, render_, log_),
      targets_(options_, render_, log_, post_) {
  set_limits(options_);
  if (!options_.security) options_.security = std::make_shared<security::Security>();
  log_.on_event([this](const wire::ExerciseEvent& event) { tell_event(event); });
  if (replay() != nullptr)
    replay()->each_event([this](const wire::ExerciseEvent& event) { log_.note(event); });
  if (replay() != nullptr) replay()->on_change([this] { post_([this] { tell_replay_state(); }); });
}

Room::~Room() {
  end();
  if (replay() != nullptr) replay()->on_change({});
}

void Room::watchers_changed(bool newcomer) {
  if (replay() == nullptr) return;
  const auto is_watched = [](const LiveRadar& radar) { return !radar.watchers.empty(); };
  replay()->watched(std::ranges::any_of(radars_.all(), is_watched), newcomer);
}

void Room::tell_replay_state() {
  for (const auto& peer : peers_) {
    peer->owes_replay_state = peer->greeted;
    if (peer->greeted) peer->kick();
  }
}

void Room::tell_news(Peer& peer) {
  if (!std::exchange(peer.owes_replay_state, false)) return;
  wire::ReplayState state;
  replay()->write_state(state);
  peer.send(MessageType::replay_state, state);
}

void Room::tell_event(const wire::ExerciseEvent& event) {
  wire::ExerciseEvents one;
  *one.add_events() = event;
  for (const auto& peer : peers_)
    if (peer->follows_events) peer->send(MessageType::exercise_events, one);
}

void Room::finish() {
  stopping_ = true;
  render_.finish();
}

void Room::on_finished() {
  post_([this] {
    for (const auto& peer : peers_) peer->finish(ErrorNumber::server_stopping, "the server is stopping");
    stopped_if_empty();
  });
}

void Room::stop() {
  stopping_ = true;
  render_.stop();
  for (const auto& peer : peers_) peer->fail(ErrorNumber::server_stopping, "the server is stopping");
  stopped_if_empty();
}

void Room::stopped_if_empty() {
  if (stopping_ && peers_.empty() && stopped_) post_(std::exchange(stopped_, nullptr));
}

void Room::set_limits(const ServerLimits& limits) {
  static_cast<ServerLimits&>(options_) = limits;
  options_.max_memory_mb = memory_limit_mb(limits.max_memory_mb);
}

RoomStatistics Room::statistics() const {
  RoomStatistics all;
  all.clients = static_cast<std::size_t>(clients());
  all.bytes_sent = bytes_sent_;
  all.frames_dropped = frames_dropped_;
  for (const auto& peer : peers_) {
    all.renders_queued += peer->renders.size();
    all.frames_dropped += peer->outbox.frames_dropped();
    all.queued_messages += peer->outbox.queued_messages();
    all.queued_bytes += peer->outbox.queued_bytes();
  }
  for (const LiveRadar& radar : radars_.all()) {
    const rendering::LiveStream::Load load = radars_.load(radar);
    all.radars.push_back({radar.name, radar.watchers.size(), radar.rate_hz, radar.coverage,
                          radar.claims.is_any_held(), !radar.faults.empty(), load.live_frames,
                          load.live_bytes, load.spare_bytes, load.frames_shed});
  }
  return all;
}

void Room::check_credentials() {
  for (const auto& peer : peers_) {
    if (!peer->credential) continue;
    if (const auto grant = options_.security->grant(*peer->credential)) {
      peer->role = grant->role;
      radars_.check_role(*peer);
      targets_.check_role(*peer);
    } else {
      peer->fail(ErrorNumber::token_refused, "the token was withdrawn");
    }
  }
}

void Room::enter(const std::shared_ptr<Peer>& peer) { peers_.push_back(peer); }

void Room::leave(const std::shared_ptr<Peer>& peer) {
  peer->has_left = true;
  post_([this, peer] { forget(*peer); });
}

void Room::forget(Peer& peer) {
  radars_.forget(peer);
  targets_.forget(peer);
  watchers_changed(false);
  for (const rendering::FrameRequestPtr& request : peer.renders) request->stop.request_stop();
  peer.renders.clear();
  if (peer.appraisal) peer.appraisal->stop.request_stop();
  peer.appraisal = nullptr;
  peer.in_turn.clear();
  queries_.forget(peer.id);
  render_.wake();
  note_freed(peer.outbox.queued_bytes());
  peer.outbox.clear();
  frames_dropped_ += peer.outbox.frames_dropped();
  std::erase_if(peers_, [&](const auto& other) { return other.get() == &peer; });
  stopped_if_empty();
}

void Room::note_freed(std::size_t bytes) {
  constexpr std::size_t kWorthIt = std::size_t{16} << 20;
  bytes_freed_ += bytes;
  if (bytes_freed_ < kWorthIt) return;
  bytes_freed_ = 0;
  // Later: then the outbox is empty. Not on the io thread, which all clients wait for; under no client's
  // name.
  post_([this] { queries_.enqueue(0, [](const std::stop_token&) { give_back_freed_memory(); }); });
}

int Room::clients() const {
  return static_cast<int>(std::ranges::count_if(peers_, [](const auto& peer) { return peer->is_client(); }));
}

std::optional<Room::NoPlace> Room::no_place_for(const Peer& peer) const {
  if (clients() >= options_.max_clients)
    return NoPlace{wire::ErrorNumber::too_many_clients,
                   "too many clients: max_clients is " + std::to_string(options_.max_clients)};
  // Of IPv6 the /64 network, which one host can have for itself.
  const std::string network = security::network_of(peer.host);
  const auto from_there = std::ranges::count_if(peers_, [&](const auto& other) {
    return other->is_client() && security::network_of(other->host) == network;
  });
  if (from_there >= options_.max_clients_per_address)
    return NoPlace{wire::ErrorNumber::too_many_from_address,
                   "too many clients from " + peer.host + ": max_clients_per_address is " +
                       std::to_string(options_.max_clients_per_address)};
  return std::nullopt;
}

void Room::make_room_before_hello() {
  std::vector<std::string> waiting;
  for (const auto& peer : peers_)
    if (peer->is_waiting()) waiting.push_back(security::network_of(peer->host));
  if (static_cast<int>(waiting.size()) < options_.max_waiting) return;
  const std::string most = security::most_crowded(waiting);
  const auto oldest = *std::ranges::find_if(peers_, [&](const auto& peer) {
    return peer->is_waiting() && security::network_of(peer->host) == most;
  });
  const LogFields fields{{"client", oldest->name}};
  log_warning(
      "{}: has not sent Hello and was closed for a new connection: server.max_waiting is {}; raise that "
      "limit, or "
      "look at the open connections",
      oldest->name, options_.max_waiting);
  oldest->drop();
}

void Room::handle(Peer& peer, MessageType type, std::span<const std::byte> descriptor) {
  const LogFields fields{{"client", peer.name}};
  Requests requests(*this, peer);
  requests.handle(type, descriptor);
  if (requests.is_kept()) peer.in_turn.push_back({type, {descriptor.begin(), descriptor.end()}});
}

void Room::appraise(Peer& peer, const rendering::AppraisalPtr& appraisal) {
  appraisal->client_id = peer.id;
  peer.appraisal = appraisal;
  render_.enqueue(appraisal);
}

void Room::on_appraised(const rendering::AppraisalPtr& appraisal, const std::vector<FieldError>& faults) {
  post_([this, appraisal, faults] {
    const auto peer = shared_peer(appraisal->client_id);
    if (!peer || peer->has_left || peer->appraisal != appraisal) return;
    try {
      handle_kept(peer, faults);
    } catch (const std::exception& e) {  // no memory, above all: it costs this client alone
      const LogFields fields{{"client", peer->name}};
      log_error("{}: {}; connection closed", peer->name, failure_text(e));
      peer->drop();
    }
  });
}

void Room::handle_kept(const std::shared_ptr<Peer>& peer, const std::vector<FieldError>& faults) {
  const LogFields fields{{"client", peer->name}};
  const Appraised appraised{std::exchange(peer->appraisal, nullptr)->version, faults};
  const Appraised* of_first = &appraised;
  while (!peer->has_left && !peer->in_turn.empty()) {
    const KeptRequest& request = peer->in_turn.front();
    Requests requests(*this, *peer, of_first);
    requests.handle(request.type, request.descriptor);
    if (requests.is_kept()) return;
    peer->in_turn.pop_front();
    of_first = nullptr;
  }
}

void Room::taken(Peer& peer, const stream::Block& block) {
  bytes_sent_ += block.sent_bytes(peer.takes_json);
  const bool last = block.type == MessageType::frame_end || block.type == MessageType::frame_abort;
  if (peer.renders.empty() || block.stream_id == 0) return;
  if (last) finish_render(peer, block.stream_id);
  render_.wake();
}

void Room::finish_render(Peer& peer, std::uint32_t stream_id) {
  std::erase_if(peer.renders,
                [&](const rendering::FrameRequestPtr& request) { return request->stream_id == stream_id; });
}

rendering::FrameCost Room::cost_queued() const {
  rendering::FrameCost sum;
  for (const auto& peer : peers_) {
    for (const rendering::FrameRequestPtr& request : peer->renders) {
      sum.pixels += request->cost.pixels;
      sum.bins += request->cost.bins;
      sum.bytes += request->cost.bytes;
    }
  }
  return sum;
}

std::optional<OverLimit> Room::over_live_limit(const RadarSettings& settings, wire::PlaneSet planes) const {
  const rendering::FrameCost cost = renderer_.fixed().empty() ? live_cost(settings, planes, options_)
                                                              : replay_cost(settings, planes, options_);
  return over_limit(settings, cost, cost_queued().bytes, options_);
}

std::optional<FieldError> Room::rate_limit_fault(double rate_hz) const {
  if (rate_hz >= 0 && rate_hz <= options_.max_rate_hz) return std::nullopt;
  return FieldError{"rate_limit_hz", std::to_string(rate_hz),
                    "0 (none) to " + std::to_string(options_.max_rate_hz)};
}

void Room::render_once(Peer& peer, const rendering::FrameRequestPtr& request) {
  request->client_id = peer.id;
  request->stream_id = ++last_stream_id_;
  peer.renders.push_back(request);
  peer.outbox.open_once_queue(request->stream_id, request->request_id, request->choice, request->queued);
  render_.enqueue(request);
}

std::shared_ptr<Peer> Room::shared_peer(std::uint64_t client_id) const {
  const auto at = std::ranges::find_if(peers_, [&](const auto& p) { return p->id == client_id; });
  return at == peers_.end() ? nullptr : *at;
}

void Room::query_ground(Peer& peer, std::uint64_t request_id,
                        std::shared_ptr<const GroundQuestion> question) {
  ++peer.queries;
  queries_.enqueue(peer.id, [this, client_id = peer.id, request_id,
                             question = std::move(question)](const std::stop_token& stop) {
    GroundAnswers answers;
    wire::Bytes records;
    try {
      answers = options_.query_ground(*question, stop);
      records = wire::encode_ground_records(answers.records);
    } catch (const std::exception& failure) {
      answers = {};
      answers.errors = {{"query", failure_text(failure), "a query that the memory there is can answer"}};
    }
    post_(
        [this, client_id, request_id, question, answers = std::move(answers), records = std::move(records)] {
          answer_query(client_id, request_id, *question, answers, records);
        });
  });
}

void Room::answer_query(std::uint64_t client_id, std::uint64_t request_id, const GroundQuestion& question,
                        const GroundAnswers& answers, std::span<const std::byte> records) {
  Peer* peer = peer_of(client_id);
  if (peer == nullptr) return;
  --peer->queries;
  if (!answers.errors.empty())
    return peer->send(MessageType::error,
                      make_error(request_id, ErrorNumber::invalid_value, "query refused", answers.errors));
  if (answers.records.size() < question.points()) return;  // stopped: the server ends
  wire::GroundAnswer answer;
  answer.set_request_id(request_id);
  answer.set_points(static_cast<std::uint32_t>(answers.records.size()));
  answer.set_record_bytes(wire::kGroundRecordBytes);
  for (const std::string& name : answers.materials) answer.add_materials(name);
  if (question.antenna) write_message(*question.antenna, *answer.mutable_antenna());
  peer->send(MessageType::ground_answer, answer, records);
}

void Room::on_live_blocks(std::size_t radar, const stream::LiveFramePtr& frame,
                          std::vector<stream::BlockPtr> blocks) {
  post_([this, radar, frame, blocks = std::move(blocks)] { radars_.deliver(radar, frame, blocks); });
}

void Room::on_live_held_up(std::size_t radar, double since_s) {
  post_([this, radar, since_s] { radars_.relieve(radar, since_s); });
}

void Room::on_live_rendered(std::size_t radar, const rendering::RenderedFrame& frame) {
  post_([this, radar, frame] { radars_.count(radar, frame); });
}

void Room::on_live_fault(std::size_t radar, const std::shared_ptr<const rendering::LiveView>& view,
                         const std::vector<FieldError>& errors) {
  post_([this, radar, view, errors] { radars_.note_fault(radar, *view, errors); });
}

void Room::on_request_block(const rendering::FrameRequestPtr& request, const stream::BlockPtr& block) {
  post_([this, request, block] {
    Peer* peer = peer_of(request->client_id);
    if (peer == nullptr) return;
    peer->outbox.push(block);
    peer->kick();
  });
}

void Room::on_request_rendered(const rendering::RenderedRequest& frame) {
  post_([this, frame] {
    if (options_.on_request_frame) options_.on_request_frame(frame);
  });
}

void Room::on_request_fault(const rendering::FrameRequestPtr& request,
                            const std::vector<FieldError>& errors) {
  post_([this, request, errors] {
    Peer* peer = peer_of(request->client_id);
    if (peer == nullptr) return;
    peer->outbox.close_queue(request->stream_id, "not rendered");
    finish_render(*peer, request->stream_id);
    peer->send(MessageType::error, make_error(request->request_id, ErrorNumber::invalid_value,
                                              "the frame cannot be rendered", errors, request->radar));
  });
}

}  // namespace obliq::net
