#include "server/net/reserved_port.h"

#include <boost/asio.hpp>

#include "server/net/tcp.h"
#include "terrain/base/errors.h"

namespace obliq::net {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;

namespace {

std::string text_of(const tcp::endpoint& endpoint) {
  return endpoint_text(endpoint.address().to_string(), endpoint.port());
}

tcp::endpoint resolve(asio::io_context& io, const std::string& address, std::uint16_t port) {
  error_code error;
  tcp::resolver resolver(io);
  const auto found = resolver.resolve(address, std::to_string(port),
                                      tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error || found.empty()) {
    throw InputError("address: found " + address + " (" + error.message() +
                     "); allowed: an address of this machine");
  }
  return found.begin()->endpoint();
}

}  // namespace

ReservedPort::ReservedPort(const std::string& address, std::uint16_t port) {
  asio::io_context io;
  const tcp::endpoint endpoint = resolve(io, address, port);
  tcp::acceptor socket(io);
  error_code error;
  const auto check = [&] {
    if (!error) return;
    std::string text = "cannot listen on " + text_of(endpoint) + ": " + error.message();
    if (error == boost::system::errc::address_in_use)
      text += "; end what listens there (another obliqd?), or take another port (0: any free one)";
    throw InputError(text);
  };
  socket.open(endpoint.protocol(), error);
  check();
  // Connections of a server that has just ended must not keep its port.
  socket.set_option(asio::socket_base::reuse_address(true), error);
  check();
  socket.bind(endpoint, error);
  check();
  is_v6_ = endpoint.address().is_v6();
  address_ = text_of(socket.local_endpoint(error));
  check();
  fd_.reset(socket.release(error));
  check();
}

}  // namespace obliq::net
