#pragma once
#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

namespace boost::asio {
class io_context;
}

namespace obliq::net {

/// Where the arithmetic of TLS handshakes is done: on one thread of low priority, the same for all servers of
/// this process, so that a flood of handshakes takes little from those who are served. Runs until the process
/// ends. Whoever has a handshake here lets nothing else touch its socket meanwhile.
boost::asio::io_context& handshakes();

}  // namespace obliq::net
