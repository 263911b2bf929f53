#include "server/security/handshakes.h"

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <thread>

#include "terrain/base/process.h"

namespace obliq::net {

namespace asio = boost::asio;

namespace {

struct HandshakeThread {
  HandshakeThread()
      : thread([this] {
          (void)lower_own_priority();  // without it a flood costs more
          io.run();
        }) {}
  ~HandshakeThread() {
    io.stop();
    thread.join();
  }
  HandshakeThread(const HandshakeThread&) = delete;
  HandshakeThread& operator=(const HandshakeThread&) = delete;

  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  std::thread thread;
};

}  // namespace

asio::io_context& handshakes() {
  static HandshakeThread only;
  return only.io;
}

}  // namespace obliq::net
