#pragma once
#include <cstdint>
#include <string>

namespace obliq::http {

struct Question {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;
  std::string path;
  /// The certificate is not verified: for a daemon that is asked on its own machine.
  bool tls = false;
  double timeout_s = 5;
};

struct Answer {
  int status = 0;     ///< 0: there was none
  std::string body;   ///< at most 64 KiB
  std::string error;  ///< why there was none
};

/// GET, within the time. Blocks; throws nothing but bad_alloc.
Answer ask(const Question& question);

}  // namespace obliq::http
