#include "server/net/io_thread.h"

#include <boost/asio.hpp>
#include <exception>
#include <thread>
#include <utility>

namespace obliq::net {

namespace asio = boost::asio;

struct IoThread::State {
  void run() {
    try {
      io.run();
    } catch (...) {  // goes on in the thread that joins
      failure = std::current_exception();
    }
  }

  asio::io_context io{1};
  asio::executor_work_guard<asio::io_context::executor_type> work{io.get_executor()};
  std::exception_ptr failure;
  std::thread thread;
};

IoThread::IoThread() : state_(std::make_unique<State>()) {
  state_->thread = std::thread([this] { state_->run(); });
}

IoThread::~IoThread() { end(); }

void IoThread::end() {
  state_->io.stop();
  if (state_->thread.joinable()) state_->thread.join();
}

asio::io_context& IoThread::context() { return state_->io; }

void IoThread::post(std::function<void()> work) { asio::post(state_->io, std::move(work)); }

void IoThread::release() {
  asio::post(state_->io, [this] { state_->work.reset(); });
}

void IoThread::join() {
  state_->thread.join();
  if (state_->failure) std::rethrow_exception(state_->failure);
}

}  // namespace obliq::net
