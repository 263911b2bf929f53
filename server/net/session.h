#pragma once
#include <cstdint>
#include <memory>

namespace boost::asio {
class io_context;
}

namespace obliq::net {

class Room;
class Transport;

/// Serves a connection until either side ends it: one coroutine reads requests, another writes the outbox.
/// Enters the room and leaves it. On the io thread.
void start_session(boost::asio::io_context& io, std::unique_ptr<Transport> transport, std::uint64_t id,
                   const std::shared_ptr<Room>& room);

}  // namespace obliq::net
