#include <array>

#include "server/control/sections/section.h"
#include "server/control/sections/server.h"

namespace obliq {
namespace {

using Stream = RowsOf<Change::restart, &SceneConfig::stream>;
constexpr std::array kRows{
    Stream::row<&StreamConfig::live_frames>(
        "stream.live_frames", closed(1, 100),
        "Most frames of one radar in memory at a time; the next waits until all clients have "
        "finished with one."),
    Stream::row<&StreamConfig::abort_after_s>(
        "stream.abort_after_s", "s", closed(0, 3600),
        "When a radar has waited this long, its oldest frame is aborted for the clients that still "
        "hold it."),
    Stream::row<&StreamConfig::lossless_limit_s>(
        "stream.lossless_limit_s", "s", closed(0.01, 3600),
        "A lossless client that holds up its radar and takes nothing for this long is dropped."),
};

}  // namespace

const Section kStreamSection{"stream", {kRows}, nullptr, true};

}  // namespace obliq
