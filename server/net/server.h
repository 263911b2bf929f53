#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/control/sections/radar.h"
#include "server/net/options.h"
#include "server/net/tcp.h"
#include "server/rendering/frame_renderer.h"
#include "server/security/security.h"

namespace boost::asio {
class io_context;
}

namespace obliq::net {

class Panel;
class Transport;

/// Listens, and serves live radars to clients. One render thread, and one io thread: the one that calls
/// run(), or one that others use as well.
class Server {
 public:
  /// Binds and listens. Throws InputError when the address is unknown or the port in use.
  Server(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
         const ServerOptions& options);
  /// Listens on a port that was taken earlier, whatever the options say.
  Server(const rendering::FrameRenderer& renderer, const std::vector<RadarConfig>& radars,
         const ServerOptions& options, ReservedPort port);
  /// As above, for start() in place of run(): on an io_context that another thread runs, and that must have
  /// ended when the server is destroyed.
  Server(boost::asio::io_context& io, const rendering::FrameRenderer& renderer,
         const std::vector<RadarConfig>& radars, const ServerOptions& options, ReservedPort port);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;   ///< the one it listens on, chosen or given
  std::string address() const;  ///< "127.0.0.1:7420"

  /// The operator's side; lives as long as the server.
  Panel& panel();

  /// Serves until stop(). Then no frame is begun any more, begun frames and queues are finished within
  /// stop_limit_s, clients are told, connections end.
  void run();
  /// Begins to serve and returns. Until stop(); `stopped` is then called on the io thread, once the last
  /// client has gone. From any thread.
  void start(std::function<void()> stopped);
  /// Replaces the limits among the options; each takes effect the next time it is looked at, also for
  /// connections that exist. On the io thread.
  void set_limits(const ServerLimits& limits);
  /// A client that came through another port: a session like all others, under the same limits. On the io
  /// thread.
  void admit(std::unique_ptr<Transport> transport);
  /// From any thread; any number of times.
  void stop();
  /// Reads certificate, key and tokens again: new connections use them, clients whose token is gone are told
  /// and closed, roles change. A faulty file leaves the old content in force. From any thread.
  security::Security::Reloaded reload_security();
  /// The part of that which concerns the clients, where several servers share one Security. From any thread.
  void check_credentials();

  /// On the io thread.
  RoomStatistics statistics() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::net
