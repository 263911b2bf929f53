#include "server/control/stream_keys.h"

#include <array>

namespace obliq {
namespace {

using Scene = SceneConfig;
const std::array kStream{
    Entry<Scene>{{"stream.live_frames",
                  "",
                  closed(1, 100),
                  {},
                  "Most frames of one radar in memory at a time; the next waits until all clients have "
                  "finished with one."},
                 [](Scene& c) -> Slot { return &c.stream.live_frames; }},
    Entry<Scene>{{"stream.abort_after_s",
                  "s",
                  closed(0, 3600),
                  {},
                  "When a radar has waited this long, its oldest frame is aborted for the clients that still "
                  "hold it."},
                 [](Scene& c) -> Slot { return &c.stream.abort_after_s; }},
    Entry<Scene>{{"stream.lossless_limit_s",
                  "s",
                  closed(0.01, 3600),
                  {},
                  "A lossless client that holds up its radar and takes nothing for this long is dropped."},
                 [](Scene& c) -> Slot { return &c.stream.lossless_limit_s; }},
};

}  // namespace

std::span<const Entry<SceneConfig>> stream_entries() { return kStream; }

}  // namespace obliq
