#pragma once
#include <functional>
#include <memory>
#include <utility>  // Boost 1.74's coroutines use std::exchange without including it

namespace boost::asio {
class io_context;
}

namespace obliq::net {

/// The thread that waits for sockets, timers and signals, from its construction on. What runs on it must be
/// short: all connections wait for it.
class IoThread {
 public:
  IoThread();
  ~IoThread();  // end()s
  IoThread(const IoThread&) = delete;
  IoThread& operator=(const IoThread&) = delete;

  boost::asio::io_context& context();
  /// Runs a function on the thread, later. From any thread.
  void post(std::function<void()> work);
  /// Lets the thread end once nothing is left to wait for. From any thread.
  void release();
  /// Waits until it has ended; throws what ended it, if that was an exception.
  void join();
  /// Ends at once, whatever there is left to do. What waits is destroyed with this object.
  void end();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace obliq::net
