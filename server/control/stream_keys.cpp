#include "server/control/stream_keys.h"

#include <array>

namespace obliq {
namespace {

using Scene = SceneConfig;
const std::array kStream{
    Entry<Scene>{
        {"stream.live_frames",
         "",
         closed(1, 100),
         {},
         "Frames of one radar in memory at a time; the next waits until all clients are done with one."},
        [](Scene& c) -> Slot { return &c.stream.live_frames; }},
    Entry<Scene>{{"stream.abort_after_s",
                  "s",
                  closed(0, 3600),
                  {},
                  "When a radar has waited for so long, clients that hold its oldest frame have it aborted."},
                 [](Scene& c) -> Slot { return &c.stream.abort_after_s; }},
    Entry<Scene>{
        {"stream.lossless_limit_s",
         "s",
         closed(0.01, 3600),
         {},
         "A lossless client that its radar waits for and that takes nothing for so long is dropped."},
        [](Scene& c) -> Slot { return &c.stream.lossless_limit_s; }},
};

}  // namespace

std::span<const Entry<SceneConfig>> stream_entries() { return kStream; }

}  // namespace obliq
