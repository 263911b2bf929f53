#include "server/net/advice.h"

namespace obliq::net {

std::string_view advice(wire::ErrorNumber number) {
  using wire::ErrorNumber;
  switch (number) {
    case ErrorNumber::bad_magic:
    case ErrorNumber::bad_length:
    case ErrorNumber::bad_crc:
    case ErrorNumber::bad_message:
    case ErrorNumber::handshake_expected:
      return "; no client of this protocol, or a broken one: see what runs there";
    case ErrorNumber::version_mismatch:
      return "; bring client and server to the same major version";
    case ErrorNumber::timed_out:
      return "; if it is a client of ours on a slow line, raise server.handshake_timeout_s or "
             "server.message_timeout_s";
    case ErrorNumber::reads_too_slowly:
      return "; it may ask for a lower rate or fewer planes, or raise server.stall_timeout_s";
    case ErrorNumber::token_refused:
      return "; if it may come, give it a token of the file server.tokens";
    case ErrorNumber::tls_required:
      return "; start that client with TLS";
    case ErrorNumber::idle:
      return "; if it is only quiet, raise server.idle_timeout_s";
    default:
      return "";
  }
}

}  // namespace obliq::net
