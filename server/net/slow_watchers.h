#pragma once
#include <vector>

#include "server/net/live_radar.h"
#include "server/net/options.h"

namespace obliq::net {

/// A radar's next frame is due and has been waiting for `held_up_s`, because as many frames as may be wait
/// for clients. Makes room at the least cost to the clients that watch:
/// 1. a frame that only waits behind others, nowhere begun and nowhere lossless, is left out;
/// 2. after abort_after_s the oldest frame that no lossless client needs is aborted where it has begun;
/// 3. a client that has held the oldest frame for stall_timeout_s, and a lossless one that has taken nothing
///    for lossless_limit_s, is disconnected with error 10.
/// On the io thread.
void relieve(LiveRadar& radar, const ServerOptions& options, double held_up_s);

}  // namespace obliq::net
