#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace obliq::wire {
class Error;
}

namespace obliq::client {

enum class Outcome {
  ok,
  bad_argument,    ///< of the caller: a malformed address, say
  cannot_connect,  ///< nothing listens there, or the name is unknown
  timed_out,
  closed,      ///< the server has gone
  bad_stream,  ///< what arrived is not the protocol, or damaged
  refused,     ///< the server answered with an Error
  aborted,     ///< a begun frame was ended by FrameAbort
  untrusted,   ///< the certificate is not for that server, or not to be trusted, or TLS is not spoken there
};

struct FieldFault {
  std::string field;
  std::string found;
  std::string allowed;
};

/// How a call ended. Nothing in this library throws on what a peer sends.
struct [[nodiscard]] Status {
  Outcome outcome = Outcome::ok;
  std::uint32_t number = 0;  ///< refused: the Error's stable number (proto/error_number.h)
  std::string text;
  std::vector<FieldFault> fields;

  bool ok() const { return outcome == Outcome::ok; }
  /// One line for people, fields included.
  std::string sentence() const;

  static Status failure(Outcome outcome, std::string text);
  static Status from_error(const wire::Error& error);
};

}  // namespace obliq::client
