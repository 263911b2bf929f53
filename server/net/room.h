#pragma once
// Everything that the clients share: the list of them, the live radars, and the render thread's results on
// their way to outboxes. Lives on the io thread; only the RenderEvents are called from elsewhere, and they
// post.
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/ground_query/query_thread.h"
#include "server/net/exercise/exercise.h"
#include "server/net/exercise/exercise_log.h"
#include "server/net/options.h"
#include "server/net/radars.h"
#include "server/net/requests/request_limits.h"
#include "server/net/target_world.h"
#include "server/rendering/render_thread.h"

namespace obliq::net {

class Room : private rendering::RenderEvents {
 public:
  using Clock = std::chrono::steady_clock;
  /// post: runs a function on the io thread, later.
  using Post = std::function<void(std::function<void()>)>;

  Room(const rendering::FrameRenderer& renderer, ServerOptions options,
       const std::vector<RadarConfig>& radars, Post post);
  ~Room() override;

  const ServerOptions& options() const { return options_; }
  const rendering::FrameRenderer& renderer() const { return renderer_; }
  Radars& radars() { return radars_; }
  Exercise& exercise() { return exercise_; }
  TargetWorld& targets() { return targets_; }
  /// Who changed what, when.
  ExerciseLog& log() { return log_; }
  Clock::duration uptime() const { return Clock::now() - started_; }
  RoomStatistics statistics() const;
  /// See Server::set_limits.
  void set_limits(const ServerLimits& limits);

  void start() { render_.start(); }
  /// Begins no further frame; when those that have begun are rendered and written, says goodbye to each
  /// client.
  void finish();
  /// The same at once: begun frames are aborted.
  void stop();
  /// Before start(): what is called, later, when the last client has gone after finish() or stop().
  void when_stopped(std::function<void()> call) { stopped_ = std::move(call); }
  /// Renders no more, on any thread: what it renders from may go.
  void end() {
    render_.end();
    queries_.end();
  }

  // Clients. Connections that have not said Hello have a few places of their own, clients all others:
  /// Those that have said Hello.
  int clients() const;
  struct NoPlace {
    wire::ErrorNumber number;
    std::string text;
  };
  /// Which limit refuses a client that has just said Hello with a good token, if any.
  std::optional<NoPlace> no_place_for(const Peer& peer) const;
  /// For a new connection: where max_waiting have not said Hello, the oldest goes, of the address that has
  /// most of them.
  void make_room_before_hello();
  /// Tokens may have been read anew: roles are taken from them; clients whose token is gone are closed.
  void check_credentials();
  void enter(const std::shared_ptr<Peer>& peer);
  /// Its connection has ended: it no longer counts as a client. The rest is posted, since the caller may be
  /// iterating over clients or watchers: control is released, subscriptions end, unfinished renders are
  /// cancelled.
  void leave(const std::shared_ptr<Peer>& peer);

  // Requests:
  /// A request has arrived: answers it, or keeps it until its turn has come. Types that are not known are
  /// skipped.
  void handle(Peer& peer, wire::MessageType type, std::span<const std::byte> descriptor);
  /// A block has left the peer's outbox.
  void taken(Peer& peer, const stream::Block& block);
  /// A peer is about to be sent its next message: what it is to hear only the newest of goes behind those
  /// that wait. However fast news comes, one a message written is queued.
  void tell_news(Peer& peer);
  /// Queues a checked request; gives it its client and its stream.
  void render_once(Peer& peer, const rendering::FrameRequestPtr& request);
  /// Asks the render thread. When it has answered, the peer's kept requests are handled from the first on.
  void appraise(Peer& peer, const rendering::AppraisalPtr& appraisal);
  /// Has a checked question answered, on another thread.
  void query_ground(Peer& peer, std::uint64_t request_id, std::shared_ptr<const GroundQuestion> question);
  /// Of all clients' unfinished RenderOnce requests.
  rendering::FrameCost cost_queued() const;
  /// Of a renderer that replays; null: none.
  rendering::ReplayControl* replay() const { return renderer_.replay(); }
  /// A client has begun to watch, or one has ended.
  void watchers_changed(bool newcomer);
  /// What limit a live radar of such settings would exceed, watched with such planes.
  std::optional<OverLimit> over_live_limit(const RadarSettings& settings, wire::PlaneSet planes) const;
  /// Why an operator may not limit a radar to such a rate.
  std::optional<FieldError> rate_limit_fault(double rate_hz) const;

 private:
  std::shared_ptr<Peer> shared_peer(std::uint64_t client_id) const;
  Peer* peer_of(std::uint64_t client_id) const { return shared_peer(client_id).get(); }
  void answer_query(std::uint64_t client_id, std::uint64_t request_id, const GroundQuestion& question,
                    const GroundAnswers& answers, std::span<const std::byte> records);
  void forget(Peer& peer);
  void note_freed(std::size_t bytes);
  void handle_kept(const std::shared_ptr<Peer>& peer, const std::vector<FieldError>& faults);
  void finish_render(Peer& peer, std::uint32_t stream_id);
  void tell_replay_state();
  void tell_event(const wire::ExerciseEvent& event);
  void stopped_if_empty();

  void on_live_blocks(std::size_t radar, const stream::LiveFramePtr& frame,
                      std::vector<stream::BlockPtr> blocks) override;
  void on_live_held_up(std::size_t radar, double since_s) override;
  void on_live_rendered(std::size_t radar, const rendering::RenderedFrame& frame) override;
  void on_live_fault(std::size_t radar, const std::shared_ptr<const rendering::LiveView>& view,
                     const std::vector<FieldError>& errors) override;
  void on_request_block(const rendering::FrameRequestPtr& request, const stream::BlockPtr& block) override;
  void on_request_rendered(const rendering::RenderedRequest& frame) override;
  void on_request_fault(const rendering::FrameRequestPtr& request,
                        const std::vector<FieldError>& errors) override;
  void on_appraised(const rendering::AppraisalPtr& appraisal, const std::vector<FieldError>& faults) override;
  void on_finished() override;

  const rendering::FrameRenderer& renderer_;
  ServerOptions options_;
  Post post_;
  Clock::time_point started_ = Clock::now();
  std::vector<std::shared_ptr<Peer>> peers_;
  std::uint32_t last_stream_id_;  ///< live radars have the first ones
  std::uint64_t bytes_sent_ = 0;
  std::function<void()> stopped_;
  bool stopping_ = false;
  std::uint64_t frames_dropped_ = 0;  ///< by clients that have left
  std::size_t bytes_freed_ = 0;       ///< that waited for clients that left, since memory was last given back
  ExerciseLog log_;
  rendering::RenderThread render_;  ///< ended before the radars go, to which it reports
  Radars radars_;
  TargetWorld targets_;
  QueryThread queries_;
  Exercise exercise_{*this};
};

}  // namespace obliq::net
