#include "server/http/http_client.h"

#include <fmt/core.h>

#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

#include "terrain/base/units.h"
// The order matters, see above.
#include <boost/asio.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/dynamic_body.hpp>
#include <boost/beast/http/parser.hpp>

namespace obliq::http {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace bhttp = boost::beast::http;
using asio::ip::tcp;

namespace {

constexpr std::uint64_t kMaxBody = 64 << 10;
constexpr std::size_t kMaxBuffer = 16 << 10;

// Beast's own reading and writing of whole messages takes GCC longer to compile than all the rest here.
template <typename Stream>
asio::awaitable<void> converse(Stream& stream, const Question& question, Answer& answer) {
  const std::string request = fmt::format("GET {} HTTP/1.1\r\nHost: {}\r\nConnection: close\r\n\r\n",
                                          question.path, question.address);
  co_await asio::async_write(stream, asio::buffer(request), asio::use_awaitable);
  // Takes memory for what has come, not for what is named.
  bhttp::response_parser<bhttp::dynamic_body> response;
  response.body_limit(kMaxBody);
  response.eager(true);
  beast::flat_buffer unread(kMaxBuffer);
  while (!response.is_done()) {
    if (unread.size() == kMaxBuffer) throw boost::system::system_error(bhttp::error::buffer_overflow);
    boost::system::error_code error;
    const std::size_t read = co_await stream.async_read_some(
        unread.prepare(kMaxBuffer - unread.size()), asio::redirect_error(asio::use_awaitable, error));
    unread.commit(read);
    if (error == asio::error::eof) {
      error = bhttp::error::end_of_stream;
      if (response.got_some()) response.put_eof(error);
    } else if (!error) {
      unread.consume(response.put(unread.data(), error));
      if (error == bhttp::error::need_more) error = {};
    }
    if (error) throw boost::system::system_error(error);
  }
  answer.body = beast::buffers_to_string(response.get().body().data());
  answer.status = static_cast<int>(response.get().result_int());
}

asio::awaitable<void> ask_on(asio::io_context& io, const Question& question, Answer& answer) {
  try {
    tcp::resolver resolver(io);
    const auto found =
        co_await resolver.async_resolve(question.address, std::to_string(question.port), asio::use_awaitable);
    tcp::socket stream(io);
    co_await asio::async_connect(stream, found, asio::use_awaitable);
    if (question.tls) {
      asio::ssl::context context(asio::ssl::context::tls_client);
      context.set_verify_mode(asio::ssl::verify_none);
      asio::ssl::stream<tcp::socket&> secure(stream, context);
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
