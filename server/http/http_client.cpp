#include "server/http/http_client.h"

#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

#include "terrain/base/units.h"
// The order matters, see above.
#include <boost/asio.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/ssl.hpp>

namespace obliq::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
using asio::ip::tcp;

namespace {

constexpr std::uint64_t kMaxBody = 64 << 10;

template <typename Stream>
asio::awaitable<void> converse(Stream& stream, const Question& question, Answer& answer) {
  bhttp::request<bhttp::empty_body> request(bhttp::verb::get, question.path, 11);
  request.set(bhttp::field::host, question.address);
  request.set(bhttp::field::connection, "close");
  co_await bhttp::async_write(stream, request, asio::use_awaitable);
  beast::flat_buffer buffer(16 << 10);
  bhttp::response_parser<bhttp::string_body> response;
  response.body_limit(kMaxBody);
  co_await bhttp::async_read(stream, buffer, response, asio::use_awaitable);
  answer.body = response.get().body();
  answer.status = static_cast<int>(response.get().result_int());
}

asio::awaitable<void> ask_on(asio::io_context& io, const Question& question, Answer& answer) {
  try {
    tcp::resolver resolver(io);
    const auto found =
        co_await resolver.async_resolve(question.address, std::to_string(question.port), asio::use_awaitable);
    beast::tcp_stream stream(io);
    co_await stream.async_connect(found, asio::use_awaitable);
    if (question.tls) {
      asio::ssl::context context(asio::ssl::context::tls_client);
      context.set_verify_mode(asio::ssl::verify_none);
      beast::ssl_stream<beast::tcp_stream&> secure(stream, context);
      co_await secure.async_handshake(asio::ssl::stream_base::client, asio::use_awaitable);
      co_await converse(secure, question, answer);
    } else {
      co_await converse(stream, question, answer);
    }
  } catch (const boost::system::system_error& e) {
    answer.error = e.code().message();
  }
}

}  // namespace

Answer ask(const Question& question) {
  Answer answer;
  asio::io_context io;
  asio::co_spawn(io, ask_on(io, question, answer), asio::detached);
  io.run_for(from_seconds(question.timeout_s));
  if (answer.status == 0 && answer.error.empty()) answer.error = "no answer in time";
  return answer;
}

}  // namespace obliq::http
