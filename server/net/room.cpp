#include "server/net/room.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "proto/obliq.pb.h"
#include "server/log/log_fields.h"
#include "server/net/requests.h"
#include "server/net/slow_watchers.h"
#include "server/net/visits.h"
#include "server/security/security.h"
#include "server/stream/frame_encoder.h"

namespace obliq::net {

using wire::ErrorNumber;
using wire::MessageType;

namespace {
/// Watchers of a radar that cannot be rendered hear why at most this often.
constexpr std::chrono::seconds kFaultPause{1};
}  // namespace

Room::Room(const FrameRenderer& renderer, ServerOptions options, const std::vector<RadarConfig>& radars,
           Post post)
    : renderer_(renderer),
      options_(std::move(options)),
      post_(std::move(post)),
      render_(renderer, *this,
              {.threads = options_.render_threads,
               .slice_bytes = options_.slice_bytes,
               .live_frames = options_.live_frames,
               .before_wedge = options_.before_wedge}) {
  if (!options_.security) options_.security = std::make_shared<Security>();
  for (const RadarConfig& config : radars) {
    radars_.emplace_back(config, ++next_stream_id_);
    render_.add_radar(config.name, next_stream_id_, radars_.back().view());
  }
}

Room::~Room() = default;

void Room::finish() {
  stopping_ = true;
  render_.finish();
}

void Room::on_finished() {
  post_([this] {
    const auto peers = peers_;  // finish() may come back through leave()
    for (const auto& peer : peers) peer->finish(ErrorNumber::server_stopping, "the server is stopping");
    stopped_if_empty();
  });
}

void Room::stop() {
  stopping_ = true;
  render_.stop();
  const auto peers = peers_;  // fail() may come back through leave()
  for (const auto& peer : peers) peer->fail(ErrorNumber::server_stopping, "the server is stopping");
  stopped_if_empty();
}

void Room::stopped_if_empty() {
  if (stopping_ && peers_.empty() && stopped_) post_(std::exchange(stopped_, nullptr));
}

void Room::set_limits(const ServerLimits& limits) { static_cast<ServerLimits&>(options_) = limits; }

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
  for (const LiveRadar& radar : radars_) {
    const LiveStream::Load load = render_.load(radar.stream_id - 1);
    all.radars.push_back({radar.name, radar.watchers.size(), radar.rate_hz, radar.coverage,
                          radar.controller != nullptr, !radar.faults.empty(), load.live_frames,
                          load.live_bytes, load.frames_shed});
  }
  return all;
}

void Room::check_credentials() {
  const auto peers = peers_;  // fail() may come back through leave()
  for (const auto& peer : peers) {
    if (!peer->credential) continue;
    if (const auto grant = options_.security->grant(*peer->credential)) {
      peer->role = grant->role;
      for (LiveRadar& radar : radars_) {
        if (peer->role >= Role::controller) continue;
        watch_no_longer_lossless(radar, *peer);
        if (radar.controller != peer.get()) continue;
        radar.controller = nullptr;
        spdlog::warn("radar {}: control released, {} is only {} now", radar.name, peer->name,
                     role_name(peer->role));
        peer->send(MessageType::error,
                   make_error(0, ErrorNumber::role_too_low,
                              "control of radar " + radar.name +
                                  " needs the role controller; this client's token gives " +
                                  std::string(role_name(peer->role)) + " now",
                              {}, radar.name));
      }
    } else {
      peer->fail(ErrorNumber::token_refused, "the token was withdrawn");
    }
  }
}

void Room::enter(const std::shared_ptr<Peer>& peer) { peers_.push_back(peer); }

void Room::leave(Peer& peer) {
  for (LiveRadar& radar : radars_) {
    unsubscribe(radar, peer);
    if (radar.controller == &peer) {
      radar.controller = nullptr;
      log_doing(peer, radar.name, "control released, " + peer.name + " has left");
    }
  }
  for (const OnceRequestPtr& request : peer.renders) request->stop.request_stop();
  peer.renders.clear();
  render_.wake();
  frames_dropped_ += peer.outbox.frames_dropped();
  std::erase_if(peers_, [&](const auto& other) { return other.get() == &peer; });
  stopped_if_empty();
}

void Room::handle(Peer& peer, MessageType type, std::span<const std::byte> descriptor) {
  const LogFields fields{{"client", peer.name}};
  Requests(*this, peer).handle(type, descriptor);
}

void Room::taken(Peer& peer, const Block& block) {
  bytes_sent_ += block.bytes.size();
  const bool last = block.type == MessageType::frame_end || block.type == MessageType::frame_abort;
  if (peer.renders.empty() || block.stream_id == 0) return;
  if (last) finish_render(peer, block.stream_id);
  render_.wake();
}

void Room::finish_render(Peer& peer, std::uint32_t stream_id) {
  std::erase_if(peer.renders, [&](const OnceRequestPtr& request) { return request->stream_id == stream_id; });
}

FrameCost Room::cost_queued() const {
  FrameCost sum;
  for (const auto& peer : peers_) {
    for (const OnceRequestPtr& request : peer->renders) {
      sum.pixels += request->cost.pixels;
      sum.bins += request->cost.bins;
      sum.bytes += request->cost.bytes;
    }
  }
  return sum;
}

std::optional<OverLimit> Room::over_live_limit(const RadarSettings& settings, wire::PlaneSet planes) const {
  return over_limit(settings, live_cost(settings, planes, options_), cost_queued().bytes, options_);
}

LiveRadar* Room::find(const std::string& name) {
  const auto at =
      std::find_if(radars_.begin(), radars_.end(), [&](const LiveRadar& r) { return r.name == name; });
  return at == radars_.end() ? nullptr : &*at;
}

void Room::unsubscribe(LiveRadar& radar, const Peer& peer) {
  const auto at = std::find_if(radar.watchers.begin(), radar.watchers.end(),
                               [&](const Watcher& watcher) { return watcher.peer == &peer; });
  if (at == radar.watchers.end()) return;
  --at->peer->subscriptions;
  at->peer->outbox.close_queue(radar.stream_id, "unsubscribed");
  radar.watchers.erase(at);
  update_demand(radar);
}

void Room::watch(LiveRadar& radar, Peer& peer, Demand demand) {
  demand.watch_id = ++last_watch_id_;
  ++peer.subscriptions;
  peer.outbox.open_live_queue(radar.stream_id, demand.choice,
                              demand.lossless ? QueuePolicy::lossless : QueuePolicy::newest_wins);
  radar.watchers.push_back({&peer, std::move(demand)});
  update_demand(radar);
}

void Room::watch_no_longer_lossless(LiveRadar& radar, Peer& peer) {
  const auto at = std::ranges::find_if(radar.watchers, [&](const Watcher& watcher) {
    return watcher.peer == &peer && watcher.demand.lossless;
  });
  if (at == radar.watchers.end()) return;
  Demand demand = at->demand;
  demand.lossless = false;
  unsubscribe(radar, peer);
  watch(radar, peer, std::move(demand));
  spdlog::warn("radar {}: {} watches without losses no longer, it is only {} now: its newest frames win",
               radar.name, peer.name, role_name(peer.role));
}

void Room::check_windows(LiveRadar& radar) const {
  const RadarSettings& settings = radar.settings.current()->settings;
  for (Watcher& watcher : radar.watchers) {
    const wire::Window& window = watcher.demand.choice.format.window;
    std::vector<FieldError> errors;
    if (window.azimuth.first >= static_cast<std::uint32_t>(settings.azimuth_bins)) {
      errors.push_back({"window.first_azimuth", std::to_string(window.azimuth.first),
                        "below " + std::to_string(settings.azimuth_bins)});
    }
    if (window.range.first >= static_cast<std::uint32_t>(settings.range_bins)) {
      errors.push_back({"window.first_range", std::to_string(window.range.first),
                        "below " + std::to_string(settings.range_bins)});
    }
    const bool told = std::exchange(watcher.window_lost, !errors.empty());
    if (errors.empty() || told) continue;
    watcher.peer->send(MessageType::error,
                       make_error(0, ErrorNumber::window_outside_frame,
                                  "radar " + radar.name + " no longer has the bins of this subscription",
                                  errors, radar.name));
  }
}

void Room::update_demand(LiveRadar& radar) {
  radar.rate_hz = 0;
  std::vector<Demand> demands;
  for (const Watcher& watcher : radar.watchers) {
    Demand demand = watcher.demand;
    if (radar.rate_limit_hz > 0) demand.rate_hz = std::min(demand.rate_hz, radar.rate_limit_hz);
    radar.rate_hz = std::max(radar.rate_hz, demand.rate_hz);
    demands.push_back(std::move(demand));
  }
  if (!radar.transmit) demands.clear();
  render_.set_demand(radar.stream_id - 1, std::move(demands));
}

void Room::publish_view(LiveRadar& radar) {
  if (radar.frozen) return;  // what it is to show after the thaw is kept in the radar
  radar.faults.clear();
  render_.set_view(radar.stream_id - 1, radar.view());
  tell_places();
}

bool Room::take_pose(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time) {
  const std::int64_t now_ns = monotonic_ns();
  if (has_sim_time) {
    if (!radar.poses->add(pose, now_ns)) return false;
  } else {
    radar.poses->set(pose, now_ns);
  }
  radar.pose = pose;
  radar.pose_received_ns = now_ns;
  radar.pose_has_sim_time = has_sim_time;
  return true;
}

void Room::flip(LiveRadar& radar, const RadarSwitches& wanted, const std::string& who) {
  if (wanted.freeze && *wanted.freeze != radar.frozen) {
    spdlog::info("radar {}: {} by {}", radar.name, *wanted.freeze ? "frozen" : "thawed", who);
    radar.frozen = *wanted.freeze;
    if (radar.frozen) {
      LiveView held = radar.view().at(monotonic_ns());
      held.poses = nullptr;  // the render thread keeps the settings and the pose of this moment
      render_.set_view(radar.stream_id - 1, std::move(held));
    } else {
      publish_view(radar);
    }
  }
  if (wanted.transmit && *wanted.transmit != radar.transmit) {
    spdlog::info("radar {}: transmit {} by {}", radar.name, *wanted.transmit ? "on" : "off", who);
    radar.transmit = *wanted.transmit;
    update_demand(radar);
  }
}

void Room::move(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time) {
  if (!take_pose(radar, pose, has_sim_time)) return;
  // The render thread reads the time line by itself; only a pose that applies at once has to wake it.
  if (has_sim_time) {
    tell_places();
  } else {
    publish_view(radar);
  }
}

void Room::tell_places() const {
  if (!options_.on_moved) return;
  std::vector<RadarPlace> places;
  for (const LiveRadar& radar : radars_) {
    places.push_back(
        {{radar.pose.longitude_deg, radar.pose.latitude_deg}, radar.settings.current()->settings.r_max_m});
  }
  options_.on_moved(std::move(places));
}

void Room::send_fault(LiveRadar& radar, Peer& peer) const {
  peer.send(MessageType::error,
            make_error(0, ErrorNumber::invalid_value, "radar " + radar.name + " cannot be rendered as it is",
                       radar.faults, radar.name));
}

Peer* Room::peer_of(const OnceRequest& request) {
  const auto at =
      std::find_if(peers_.begin(), peers_.end(), [&](const auto& p) { return p->id == request.client_id; });
  return at == peers_.end() ? nullptr : at->get();
}

void Room::on_live_blocks(std::size_t radar, const LiveFramePtr& frame, std::vector<BlockPtr> blocks) {
  post_([this, radar, frame, blocks = std::move(blocks)] {
    for (const Watcher& watcher : radars_[radar].watchers) {
      if (!frame->is_for(watcher.demand.watch_id)) continue;
      for (const BlockPtr& block : blocks) watcher.peer->outbox.push(block, frame);
      watcher.peer->kick();
    }
  });
}

void Room::on_live_held_up(std::size_t radar, double since_s) {
  post_([this, radar, since_s] { relieve(radars_[radar], options_, since_s); });
}

void Room::on_live_rendered(std::size_t index, const RenderedFrame& frame) {
  post_([this, index, frame] {
    LiveRadar& radar = radars_[index];
    ++radar.frames;
    radar.last_render_s = frame.render_s;
    radar.coverage = frame.coverage;
    radar.rays = frame.rays;
    radar.hits = frame.hits;
    radar.faults.clear();
    radar.dwells_missed += frame.dwells_missed;
    if (options_.on_frame) options_.on_frame(radar.name, frame);
  });
}

void Room::on_live_fault(std::size_t index, const std::shared_ptr<const LiveView>& view,
                         const std::vector<FieldError>& errors) {
  post_([this, index, view, errors] {
    LiveRadar& radar = radars_[index];
    // Its controller may have mended it in the meantime.
    if (!radar.frozen) {
      if (view->settings != radar.settings.current()) return;
      if (!radar.pose_has_sim_time && view->pose_received_ns != radar.pose_received_ns) return;
    }
    radar.faults = errors;
    // A pose that moves on brings a new fault with every frame.
    const auto now = std::chrono::steady_clock::now();
    if (radar.faults_settings == view->settings && now < radar.faults_told + kFaultPause) return;
    radar.faults_settings = view->settings;
    radar.faults_told = now;
    const LogFields fields{{"radar", radar.name}};
    for (const FieldError& error : errors)
      spdlog::warn("radar {}: {}; no frames until its settings or its pose are changed", radar.name,
                   error.text());
    for (const Watcher& watcher : radar.watchers) send_fault(radar, *watcher.peer);
  });
}

void Room::on_once_block(const OnceRequestPtr& request, const BlockPtr& block) {
  post_([this, request, block] {
    Peer* peer = peer_of(*request);
    if (peer == nullptr) return;
    peer->outbox.push(block);
    peer->kick();
  });
}

void Room::on_once_rendered(const RenderedOnce& frame) {
  post_([this, frame] {
    if (options_.on_once_frame) options_.on_once_frame(frame);
  });
}

void Room::on_once_fault(const OnceRequestPtr& request, const std::vector<FieldError>& errors) {
  post_([this, request, errors] {
    Peer* peer = peer_of(*request);
    if (peer == nullptr) return;
    peer->outbox.close_queue(request->stream_id, "not rendered");
    finish_render(*peer, request->stream_id);
    peer->send(MessageType::error, make_error(request->request_id, ErrorNumber::invalid_value,
                                              "the frame cannot be rendered", errors, request->radar));
  });
}

}  // namespace obliq::net
