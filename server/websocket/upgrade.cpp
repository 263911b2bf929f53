#include "server/websocket/upgrade.h"

#include <utility>

#include "server/net/server.h"
#include "server/websocket/json_message.h"
#include "server/websocket/web_socket_transport.h"

namespace obliq::websocket {

http::Upgrade upgrade(boost::asio::io_context& io, std::function<net::Server*()> serving,
                      std::function<http::Page()> obstacle) {
  http::Upgrade upgrade;
  upgrade.path = kPath;
  upgrade.protocol = kSubprotocol;
  upgrade.obstacle = [serving, obstacle = std::move(obstacle)]() -> std::optional<http::Page> {
    if (serving() != nullptr) return std::nullopt;
    return obstacle();
  };
  upgrade.take = [&io, serving](std::unique_ptr<net::SocketTransport> socket, std::string header,
                                std::string unread) {
    serving()->admit(
        std::make_unique<WebSocketTransport>(io, std::move(socket), std::move(header), std::move(unread)));
  };
  return upgrade;
}

}  // namespace obliq::websocket
