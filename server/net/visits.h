#pragma once
// What the log says of connections. One that watches or flies has a line when that begins and one when it
// goes; one that has only asked something has a single line, at its end; one that has only set a pose has
// none. The level debug has them all as they come.
#include <string>

#include "proto/message_type.h"

namespace obliq::net {

class Peer;

/// A peer has been greeted. `introduction`: its role, and whose token it has.
void log_arrival(Peer& peer, const std::string& introduction);
/// It asks for something.
void log_request(Peer& peer, wire::MessageType type);
/// It is more than a passer-by: from now on its doings are told as they come.
void log_as_guest(Peer& peer);
/// What it does with a radar.
void log_doing(const Peer& peer, const std::string& radar, const std::string& what);
void log_end(const Peer& peer);

}  // namespace obliq::net
