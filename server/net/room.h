#pragma once
// Everything that the clients share: who is there, the live radars, and the render thread's results on their
// way to outboxes. Lives on the io thread; only the RenderEvents are called from elsewhere, and they post.
#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/net/live_radar.h"
#include "server/net/options.h"
#include "server/net/request_limits.h"
#include "server/net/statistics.h"
#include "server/rendering/render_thread.h"

namespace obliq::net {

class Room : private RenderEvents {
 public:
  /// post: runs a function on the io thread, later.
  using Post = std::function<void(std::function<void()>)>;

  Room(const FrameRenderer& renderer, ServerOptions options, const std::vector<RadarConfig>& radars,
       Post post);
  ~Room() override;

  const ServerOptions& options() const { return options_; }
  void start() { render_.start(); }
  /// Begins no further frame; when those that have begun are rendered and written, says goodbye to each
  /// client.
  void finish();
  /// The same at once: begun frames are aborted.
  void stop();
  /// Before start(): what is called, later, when the last client has gone after finish() or stop().
  void when_stopped(std::function<void()> call) { stopped_ = std::move(call); }
  /// Renders no more, on any thread: what it renders from may go.
  void end() { render_.end(); }
  RoomStatistics statistics() const;
  /// See Server::set_limits.
  void set_limits(const ServerLimits& limits);

  /// Those that have said Hello.
  int clients() const;
  struct NoPlace {
    wire::ErrorNumber number;
    std::string text;
  };
  /// What limit keeps one out that has just said Hello with a good token, if any.
  std::optional<NoPlace> no_place_for(const Peer& peer) const;
  /// For a newcomer: where max_waiting connections have not said Hello, the oldest goes, of the address that
  /// has most of them.
  void make_room_before_hello();
  /// Tokens may have been read anew: roles are taken from them, and who came with one that is gone is closed.
  void check_credentials();
  void enter(const std::shared_ptr<Peer>& peer);
  /// Control is released, subscriptions end, unfinished renders are cancelled.
  void leave(Peer& peer);

  /// A request has arrived: answers it. Types that are not known are skipped.
  void handle(Peer& peer, wire::MessageType type, std::span<const std::byte> descriptor);
  /// A block has left the peer's outbox.
  void taken(Peer& peer, const Block& block);

 private:
  friend class Panel;
  friend class Requests;

  LiveRadar* find(const std::string& name);
  void unsubscribe(LiveRadar& radar, const Peer& peer);
  void update_demand(LiveRadar& radar);
  void publish_view(LiveRadar& radar);
  /// False: it came late, and was left out.
  bool take_pose(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time);
  /// The only place where transmit and freeze change. `who` stands in the log.
  void flip(LiveRadar& radar, const RadarSwitches& wanted, const std::string& who);
  /// A valid pose has come: with a sim time it joins the radar's time line, else it applies at once.
  void move(LiveRadar& radar, const PoseSettings& pose, bool has_sim_time);
  void tell_places() const;
  /// Says in the log, once, that a radar has left the ground that files cover, or come back. Empty: it is
  /// there.
  static void note_ground(LiveRadar& radar, const std::string& warning);
  void send_fault(LiveRadar& radar, Peer& peer) const;
  void watch(LiveRadar& radar, Peer& peer, Demand demand);
  /// A subscription that held the radar up gets its newest frames from now on.
  void watch_no_longer_lossless(LiveRadar& radar, Peer& peer);
  /// Tells those who watch a part of the radar's frame that is no longer there.
  void check_windows(LiveRadar& radar) const;
  Peer* peer_of(const OnceRequest& request);
  void stopped_if_empty();
  void finish_render(Peer& peer, std::uint32_t stream_id);
  /// Of all clients' unfinished RenderOnce requests.
  FrameCost cost_queued() const;
  /// What limit a live radar of such settings would exceed, watched with such planes.
  std::optional<OverLimit> over_live_limit(const RadarSettings& settings, wire::PlaneSet planes) const;

  void on_live_blocks(std::size_t radar, const LiveFramePtr& frame, std::vector<BlockPtr> blocks) override;
  void on_live_held_up(std::size_t radar, double since_s) override;
  void on_live_rendered(std::size_t radar, const RenderedFrame& frame) override;
  void on_live_fault(std::size_t radar, const std::shared_ptr<const LiveView>& view,
                     const std::vector<FieldError>& errors) override;
  void on_once_block(const OnceRequestPtr& request, const BlockPtr& block) override;
  void on_once_rendered(const RenderedOnce& frame) override;
  void on_once_fault(const OnceRequestPtr& request, const std::vector<FieldError>& errors) override;
  void on_finished() override;

  const FrameRenderer& renderer_;
  ServerOptions options_;
  Post post_;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::deque<LiveRadar> radars_;  ///< a deque: radars stay where they are
  std::vector<std::shared_ptr<Peer>> peers_;
  std::uint32_t next_stream_id_ = 0;
  std::uint64_t last_watch_id_ = 0;
  std::uint64_t bytes_sent_ = 0;
  std::function<void()> stopped_;
  bool stopping_ = false;
  std::uint64_t frames_dropped_ = 0;  ///< by clients that have left
  RenderThread render_;               ///< last: stopped before what it reports to goes
};

}  // namespace obliq::net
