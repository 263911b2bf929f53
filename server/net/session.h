#pragma once
#include <cstdint>
#include <memory>

namespace boost::asio {
class io_context;
}

namespace obliq::net {

class Room;

/// Serves a connected socket, whose ownership it takes, until either side ends: one coroutine reads requests,
/// another writes the outbox. Enters the room and leaves it. On the io thread.
void start_session(boost::asio::io_context& io, int socket_fd, bool is_ipv6, std::uint64_t id,
                   const std::shared_ptr<Room>& room);

}  // namespace obliq::net
