#pragma once
// What an obliq_client of c.h keeps, and how its functions end. For c*.cpp alone; include proto/obliq.pb.h
// before.
#include <cstdint>
#include <exception>
#include <limits>
#include <string>
#include <vector>

#include "client/c.h"
#include "client/c_frames.h"
#include "client/client.h"
#include "client/frame_assembler.h"

struct obliq_client {
  obliq::client::Client client;
  obliq::client::FramesOfStreams frames;
  obliq::client::AssembledFrame shown;  ///< what the newest obliq_frame points into
  std::string radar;                    ///< its name
  std::vector<obliq_truth> truth;       ///< its targets
  obliq::wire::ExerciseEvents events;   ///< of the newest answer
  obliq::wire::TargetList targets;      ///< of the newest answer
  obliq_route route{};                  ///< of the newest obliq_target
  std::vector<std::string> warnings;    ///< of the newest call
  std::string warning_lines;            ///< the same, a line each
  std::string error;
  std::uint32_t number = 0;
};

namespace obliq::client::c {

constexpr std::int64_t kNoTime = std::numeric_limits<std::int64_t>::min();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// What a caller may leave out.
inline std::string text_of(const char* text) { return text != nullptr ? text : ""; }

inline Status bad(const std::string& text) { return Status::failure(Outcome::bad_argument, text); }

/// Runs a call; whatever it ends with becomes a number and a sentence.
template <class Call>
int guarded(obliq_client* self, Call call) noexcept {
  if (self == nullptr) return OBLIQ_BAD_ARGUMENT;
  try {
    self->warnings.clear();
    self->warning_lines.clear();
    const Status status = call();
    self->number = status.number;
    self->error = status.ok() ? "" : status.sentence();
    for (const std::string& warning : self->warnings) self->warning_lines += warning + "\n";
    return static_cast<int>(status.outcome);
  } catch (const std::exception& e) {
    self->number = 0;
    try {
      self->error = e.what();
    } catch (...) {  // no memory for the words either
      self->error.clear();
    }
  } catch (...) {
    self->number = 0;
  }
  return OBLIQ_FAILED;
}

/// Fills self.truth with where targets are in the frame that is shown.
void read_truth(obliq_client& self);

}  // namespace obliq::client::c
