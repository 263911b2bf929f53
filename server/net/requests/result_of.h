#pragma once
// A callback as something that a coroutine waits for. The headers of Boost stay in sources: include
// <boost/asio.hpp> before this.
#include <memory>
#include <type_traits>
#include <utility>

namespace obliq::net {

/// Waits for an operation of a Transport: `start` gets the function to call when it is done.
template <typename Result, typename Start>
boost::asio::awaitable<Result> result_of(Start start) {
  // What resumes a coroutine can only be moved, a std::function must be copied.
  return boost::asio::async_initiate<const boost::asio::use_awaitable_t<>&, void(Result)>(
      [start = std::move(start)](auto&& handler) mutable {
        auto shared =
            std::make_shared<std::decay_t<decltype(handler)>>(std::forward<decltype(handler)>(handler));
        start([shared](Result result) { std::move (*shared)(std::move(result)); });
      },
      boost::asio::use_awaitable);
}

}  // namespace obliq::net
