#pragma once
// `obliq replay --serve`: a recording in the place of obliqd's radars.
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/recording/recorded_frames.h"
#include "server/apps/replay/replay_player.h"

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace obliq {

struct ServeArguments {
  std::string config;            ///< scene file of [server], [stream] and [http]; empty: none
  std::vector<std::string> set;  ///< KEY=VALUE of these
  // Short for some of them:
  std::optional<std::string> address;
  std::optional<std::uint16_t> port;
  std::optional<std::uint16_t> http_port;
  bool unprotected = false;
  std::optional<double> max_memory_mb;
};

/// Adds all of them, each of which needs `serve`. `arguments` must outlive the parsing.
void add_serve_arguments(CLI::App& command, CLI::Option* serve, ServeArguments& arguments);

/// Serves radars of a recording, in step, each on ports of its own, until the recording ends or a signal says
/// stop; SIGHUP reads tokens and certificate again. Throws InputError.
client::RecordingLosses serve_recording(const ServeArguments& arguments, const std::string& file,
                                        std::vector<client::RecordingStart> starts,
                                        const ReplayOptions& options);

}  // namespace obliq
