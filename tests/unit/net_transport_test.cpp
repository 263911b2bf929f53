// What the kernel is told about a connection.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/net/io_thread.h"
#include "server/net/socket_transport.h"
#include "server/security/networks.h"

namespace obliq::test {
namespace {

/// What a transport makes of the send buffer and the peer's address, when a peer on 127.0.0.1 comes to a
/// listener of IPv4, or to one of IPv6 that takes IPv4 as well. False: no IPv6 here.
bool look(bool dual_stack, int& send_bytes, std::string& host) {
  const int family = dual_stack ? AF_INET6 : AF_INET;
  const int listener = ::socket(family, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (listener < 0) return false;
  sockaddr_storage address{};  // all zeros: any address, any port
  address.ss_family = static_cast<sa_family_t>(family);
  socklen_t size = dual_stack ? sizeof(sockaddr_in6) : sizeof(sockaddr_in);
  const int off = 0;
  if (dual_stack) (void)::setsockopt(listener, IPPROTO_IPV6, IPV6_V6ONLY, &off, sizeof off);
  if (::bind(listener, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
    ::close(listener);
    return false;
  }
  EXPECT_EQ(::listen(listener, 1), 0);
  EXPECT_EQ(::getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size), 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  to.sin_port = dual_stack ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                           : reinterpret_cast<const sockaddr_in&>(address).sin_port;
  const int peer = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  EXPECT_EQ(::connect(peer, reinterpret_cast<const sockaddr*>(&to), sizeof to), 0);
  const int accepted = ::accept(listener, nullptr, nullptr);
  {
    net::IoThread io;
    const net::SocketTransport transport(io.context(), accepted, dual_stack, nullptr);
    host = transport.host();
    socklen_t length = sizeof send_bytes;
    EXPECT_EQ(::getsockopt(accepted, SOL_SOCKET, SO_SNDBUF, &send_bytes, &length), 0);
    io.end();
  }
  ::close(peer);
  ::close(listener);
  return true;
}

TEST(Transport, APeerOfThisMachineHasTheSameSendBufferWhateverClothesItsAddressWears) {
  int plain_bytes = 0;
  int mapped_bytes = 0;
  std::string host;
  ASSERT_TRUE(look(false, plain_bytes, host));
  EXPECT_EQ(host, "127.0.0.1");
  if (!look(true, mapped_bytes, host)) GTEST_SKIP() << "no IPv6 here";
  EXPECT_EQ(host, "::ffff:127.0.0.1");
  EXPECT_EQ(mapped_bytes, plain_bytes);
}

TEST(Exposure, LoopbackInIPv6ClothesIsLoopback) {
  for (const char* here : {"127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.1", "localhost"})
    EXPECT_TRUE(net::resolves_to_loopback(here)) << here;
  for (const char* everywhere : {"0.0.0.0", "::", "::ffff:192.0.2.7", "192.0.2.7", ""})
    EXPECT_FALSE(net::resolves_to_loopback(everywhere)) << everywhere;
}

}  // namespace
}  // namespace obliq::test
