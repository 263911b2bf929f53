#pragma once
// What the log says of connections. A client that watches or flies gets a line when that begins and one when
// it leaves; one that only asks something gets a single line, at its end; one that only sets a pose gets
// none. The level debug shows all of them as they happen.
#include <string>
#include <string_view>

#include "proto/error_number.h"
#include "proto/message_type.h"

namespace obliq::net {

class Peer;

/// Hello was answered. `introduction`: the role, and the name of the token.
void log_arrival(Peer& peer, const std::string& introduction);
/// A request has arrived.
void log_request(Peer& peer, wire::MessageType type);
/// It is more than a passer-by: from now on what it does is logged at once.
void log_as_guest(Peer& peer);
/// What it does with a radar.
void log_doing(const Peer& peer, const std::string& radar, const std::string& what);
void log_end(const Peer& peer);

/// What an operator can do about a client that was closed with this error; begins with "; ", or is empty.
std::string_view advice(wire::ErrorNumber number);

}  // namespace obliq::net
