#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/control/radar_config.h"
#include "server/net/frame_renderer.h"
#include "server/net/options.h"
#include "server/net/reserved_port.h"

namespace obliq::net {

/// Listens, and serves live radars to clients. One io thread, which is the one that calls run(), and one
/// render thread.
class Server {
 public:
  /// Binds and listens. Throws InputError when the address is unknown or the port in use.
  Server(const FrameRenderer& renderer, const std::vector<RadarConfig>& radars, const ServerOptions& options);
  /// Listens on a port that was taken earlier, whatever the options say.
  Server(const FrameRenderer& renderer, const std::vector<RadarConfig>& radars, const ServerOptions& options,
         ReservedPort port);
  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  std::uint16_t port() const;   ///< the one it listens on, chosen or given
  std::string address() const;  ///< "127.0.0.1:7420"

  /// Serves until stop(), or a signal if the options say so: begun frames are aborted, clients told, threads
  /// joined.
  void run();
  /// From any thread; any number of times.
  void stop();
  /// Reads certificate, key and tokens anew: new connections use them, clients whose token is gone are told
  /// and closed, roles change. From any thread. Throws InputError, and then everything is as it was.
  void reload_security();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::net
