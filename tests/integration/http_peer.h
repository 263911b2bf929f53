#pragma once
// HTTP as bytes on a plain socket, so that a test can say what a library never would.
#include <cstdint>
#include <string>
#include <string_view>

namespace obliq::test {

struct HttpReply {
  int status = 0;       ///< 0: the connection ended, or stood still for 20 s, without an answer
  std::string headers;  ///< lower case, the status line first
  std::string body;
};

/// A connection to 127.0.0.1, from another address of this machine if need be.
class HttpPeer {
 public:
  explicit HttpPeer(std::uint16_t port, const char* from = "127.0.0.1");
  ~HttpPeer();
  HttpPeer(const HttpPeer&) = delete;
  HttpPeer& operator=(const HttpPeer&) = delete;

  /// False when the peer does not take it any more.
  bool send(std::string_view text) const;
  /// The next answer on the connection. One to HEAD has no body.
  HttpReply receive(bool head = false);
  /// What comes until the peer closes; false when it does not within 20 s.
  bool closed();

 private:
  bool more();
  int fd_ = -1;
  std::string received_;
};

/// GET on a connection of its own.
HttpReply http_get(std::uint16_t port, const std::string& path);

/// The port in "127.0.0.1:PORT".
std::uint16_t port_of(const std::string& address);

}  // namespace obliq::test
