#pragma once
// What a frame asks of the server, held against the operator's limits.
#include <cstdint>
#include <optional>
#include <string>

#include "proto/plane.h"
#include "server/net/options.h"
#include "server/radar/settings.h"
#include "server/rendering/rendered.h"
#include "terrain/base/errors.h"

namespace obliq::net {

/// Memory while a frame is rendered and sent: the current wedges, one a thread, with the bins and pixels that
/// are theirs, the plan of a beam and what it adds up (server/radar/wedge_memory.h), and the encoded planes
/// that wait to be sent. Of a RenderOnce frame those are at most twice slice_bytes, of a live radar's at most
/// queue_frames + 1 whole frames. Scene and terrain are not in it: they are resident already.
rendering::FrameCost once_cost(const RadarSettings& settings, wire::PlaneSet planes,
                               const ServerOptions& options);
rendering::FrameCost live_cost(const RadarSettings& settings, wire::PlaneSet planes,
                               const ServerOptions& options);
/// Of a recorded frame: it is read as a whole, and not rendered.
rendering::FrameCost replay_cost(const RadarSettings& settings, wire::PlaneSet planes,
                                 const ServerOptions& options);

/// Of one that is rendered and kept as a whole (BinBlock), without a server.
rendering::FrameCost whole_cost(const RadarSettings& settings, const ServerOptions& options);

struct OverLimit {
  std::string limit;  ///< its name: "max_bins"
  std::string text;   ///< "max_bins is 639: ..."
  FieldError field;
};

/// What of max_pixels, max_bins, max_plan_taps and max_memory_mb such a frame exceeds, if anything;
/// max_memory_mb as a figure. reserved_bytes: of other requests that are accepted and not finished. By
/// arithmetic alone.
std::optional<OverLimit> over_limit(const RadarSettings& settings, const rendering::FrameCost& cost,
                                    std::int64_t reserved_bytes, const ServerOptions& options);
/// Of these, max_memory_mb alone.
std::optional<OverLimit> over_memory(const RadarSettings& settings, const rendering::FrameCost& cost,
                                     std::int64_t reserved_bytes, const ServerOptions& options);
/// Whether it may wait behind what waits already, of all clients: max_work_queued.
std::optional<OverLimit> over_queue(const rendering::FrameCost& cost, std::int64_t work_queued,
                                    const ServerOptions& options);

}  // namespace obliq::net
