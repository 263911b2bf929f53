#pragma once
#include <functional>

#include "server/http/http_server.h"

namespace obliq::net {
class Server;
}

namespace obliq::websocket {

constexpr const char* kPath = "/stream";

/// For an HttpServer on the io_context of the stream's server: connections to kPath become clients of that
/// server. `serving` tells which, or null while there is none yet; `obstacle` answers meanwhile.
http::Upgrade upgrade(boost::asio::io_context& io, std::function<net::Server*()> serving,
                      std::function<http::Page()> obstacle);

}  // namespace obliq::websocket
