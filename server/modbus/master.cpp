// One master's conversation. Requests are received here, not by modbus_receive(): libmodbus 3.1.6 allows its
// byte_timeout again for each byte, so a master that dribbles is never cut off, and a malformed frame costs
// it half a second and whatever else has arrived. We read whole frames against one deadline, check them
// (request.cpp), and have libmodbus make and send the answers.
#include "server/modbus/master.h"

#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <new>
#include <span>
#include <vector>

#include "server/log/log.h"
#include "terrain/base/errors.h"

namespace obliq::modbus {
namespace {

using Clock = std::chrono::steady_clock;

class Socket {
 public:
  Socket(int fd, int stop_fd, std::chrono::milliseconds answer_time) : fd_(fd), stop_fd_(stop_fd) {
    const int on = 1;
    const timeval patience{answer_time.count() / 1000, answer_time.count() % 1000 * 1000};
    // What fails here costs speed or patience, not correctness.
    (void)setsockopt(fd, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
    (void)setsockopt(fd, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
    (void)setsockopt(fd, SOL_SOCKET, SO_SNDTIMEO, &patience, sizeof patience);
  }
  /// Fills the bytes by the deadline. False: the master has left or is too slow, or we are to stop.
  bool receive(std::span<std::uint8_t> bytes, Clock::time_point deadline) const {
    while (!bytes.empty()) {
      if (!wait(deadline)) return false;
      const ssize_t n = recv(fd_, bytes.data(), bytes.size(), MSG_DONTWAIT);
      if (n < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (n <= 0) return false;
      bytes = bytes.subspan(static_cast<std::size_t>(n));
    }
    return true;
  }

 private:
  bool wait(Clock::time_point deadline) const {
    for (;;) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now()).count();
      if (left <= 0) return false;
      pollfd fds[] = {{fd_, POLLIN, 0}, {stop_fd_, POLLIN, 0}};
      const int n = poll(fds, 2, static_cast<int>(std::min<std::int64_t>(left, 3600'000)));
      if (n < 0 && errno != EINTR) return false;
      if (n > 0 && fds[1].revents != 0) return false;
      if (n > 0 && fds[0].revents != 0) return true;
    }
  }

  int fd_;
  int stop_fd_;
};

struct ContextDeleter {
  void operator()(modbus_t* context) const { modbus_free(context); }
};
struct MappingDeleter {
  void operator()(modbus_mapping_t* mapping) const { modbus_mapping_free(mapping); }
};

/// Makes the answers of one connection.
class Answers {
 public:
  explicit Answers(int socket)
      : context_(modbus_new_tcp("127.0.0.1", 0)),  // never connected: the socket is there
        mapping_(modbus_mapping_new(std::tuple_size_v<decltype(Registers::coils)>,
                                    std::tuple_size_v<decltype(Registers::discrete)>, kRegisters,
                                    kRegisters)) {
    if (!context_ || !mapping_) throw std::bad_alloc();
    modbus_set_socket(context_.get(), socket);
    // Where libmodbus would wait before it flushes a request it dislikes: not at all.
    modbus_set_response_timeout(context_.get(), 0, 1);
  }

  /// The answer's function code is the request's with its highest bit set (V1.1b3, section 7). libmodbus adds
  /// that bit: of a request that has it already it would make function 0.
  bool refuse(std::vector<std::uint8_t>& frame, Exception exception) {
    frame[kFunctionAt] &= 0x7F;
    return modbus_reply_exception(context_.get(), frame.data(), static_cast<unsigned>(exception)) >= 0;
  }

  /// Writes have been done already: libmodbus repeats them in its own mapping, which nothing else reads.
  bool reply(std::span<const std::uint8_t> frame, const Registers& registers) {
    std::ranges::copy(registers.coils, mapping_->tab_bits);
    std::ranges::copy(registers.discrete, mapping_->tab_input_bits);
    std::ranges::copy(registers.holding, mapping_->tab_registers);
    std::ranges::copy(registers.input, mapping_->tab_input_registers);
    return modbus_reply(context_.get(), frame.data(), static_cast<int>(frame.size()), mapping_.get()) >= 0;
  }

 private:
  std::unique_ptr<modbus_t, ContextDeleter> context_;
  std::unique_ptr<modbus_mapping_t, MappingDeleter> mapping_;
};

/// One request and its answer. False: there will be no other.
bool serve_request(const Socket& socket, const MasterTimes& times, Image& image, Answers& answers,
                   std::vector<std::uint8_t>& frame) {
  frame.resize(kHeadBytes);
  const auto idle = std::chrono::duration_cast<Clock::duration>(times.idle);
  if (!socket.receive(std::span(frame).first(1), Clock::now() + idle)) return false;
  const auto deadline = Clock::now() + times.frame;
  if (!socket.receive(std::span(frame).subspan(1), deadline)) return false;
  const std::size_t rest = bytes_to_come(std::span<const std::uint8_t, kHeadBytes>(frame));
  if (rest == 0) {
    log_warning("modbus: a master sent something other than Modbus/TCP and is disconnected");
    return false;
  }
  frame.resize(kHeadBytes + rest);
  if (!socket.receive(std::span(frame).subspan(kHeadBytes), deadline)) return false;

  Request request;
  Registers registers;
  Exception exception = parse(frame, request);
  if (exception == Exception::none) exception = image.perform(request, registers);
  return exception == Exception::none ? answers.reply(frame, registers) : answers.refuse(frame, exception);
}

}  // namespace

bool is_fit_for_libmodbus(int socket) { return socket >= 0 && socket < FD_SETSIZE; }

void serve_master(int fd, int stop_fd, const MasterTimes& times, Image& image) {
  const Socket socket(fd, stop_fd, times.frame);
  try {
    Answers answers(fd);
    std::vector<std::uint8_t> frame;
    frame.reserve(kMostBytes);
    while (serve_request(socket, times, image, answers, frame)) {
    }
  } catch (const std::exception& e) {
    log_error("modbus: a master is disconnected: {}", failure_text(e));
  }
}

}  // namespace obliq::modbus
