#pragma once
// How a command asks for frames: encoding, compression, and which bins.
#include <string>

#include "proto/bin_window.h"

namespace CLI {
class App;
}
namespace obliq::wire {
class Subscribe;
class RenderOnce;
}  // namespace obliq::wire

namespace obliq {

struct StreamArguments {
  std::string encoding;
  std::string compression;
  std::string azimuths;
  std::string ranges;
};

/// Adds --encoding, --compress, --azimuths and --ranges. `arguments` must outlive the parsing.
void add_stream_arguments(CLI::App& app, StreamArguments& arguments);

/// Writes them into a request. Throws InputError.
void ask_for(const StreamArguments& arguments, wire::Subscribe& request);
void ask_for(const StreamArguments& arguments, wire::RenderOnce& request);

/// "FIRST:END:STEP", each part optional, bins below END. Throws InputError that names the option.
wire::BinRun parse_bin_run(const std::string& text, const std::string& option);

}  // namespace obliq
