#include "server/modbus/service.h"

#include <fcntl.h>
#include <fmt/core.h>
#include <netdb.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <list>
#include <thread>

#include "server/log/log.h"
#include "server/log/service_log.h"
#include "server/modbus/image.h"
#include "server/modbus/master.h"
#include "server/security/networks.h"
#include "terrain/base/errors.h"
#include "terrain/base/files.h"

namespace obliq::modbus {
namespace {

/// Between looks at the watchdogs and requests for fresh status.
constexpr int kTick_ms = 100;

std::string system_text() { return std::generic_category().message(errno); }

struct Master {
  Master(std::string host, int fd) : address(std::move(host)), socket(fd) {}

  std::string address;
  UniqueFd socket;
  std::atomic<bool> done = false;
  std::jthread thread;  ///< last: joined before the socket is closed
};

std::string host_of(const sockaddr_storage& peer, socklen_t length) {
  std::array<char, NI_MAXHOST> host{};
  const auto* address = reinterpret_cast<const sockaddr*>(&peer);
  if (getnameinfo(address, length, host.data(), host.size(), nullptr, 0, NI_NUMERICHOST) != 0) return "?";
  return host.data();
}

}  // namespace

struct Service::State {
  State(const ModbusConfig& settings, net::ReservedPort reserved, net::Panel& radars,
        std::chrono::milliseconds frame_time)
      : config(settings),
        times{std::chrono::duration<double>(settings.idle_timeout_s), frame_time},
        panel(radars),
        image(radars, settings.watchdog_s),
        address(reserved.address()),
        listener(reserved.release()),
        stop(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
    // Not blocking: a connection may be gone again when we come to accept it.
    if (!stop || fcntl(listener.get(), F_SETFL, O_NONBLOCK) != 0 || listen(listener.get(), SOMAXCONN) != 0)
      throw InputError("modbus: cannot listen on " + address + ": " + system_text());
    thread = std::jthread([this] { run(); });
  }

  ~State() {
    const std::uint64_t one = 1;
    while (write(stop.get(), &one, sizeof one) < 0 && errno == EINTR) {
    }
    thread.join();
    // Every one of them sees the stop, but for those whose answer waits for a master that does not read.
    for (Master& master : masters) shutdown(master.socket.get(), SHUT_RDWR);
    masters.clear();  // joins
  }

  void run() {
    for (;;) {
      pollfd fds[] = {{listener.get(), POLLIN, 0}, {stop.get(), POLLIN, 0}};
      const int n = poll(fds, 2, kTick_ms);
      if (n > 0 && fds[1].revents != 0) return;
      try {
        std::erase_if(masters, [](const Master& master) { return master.done.load(); });
        if (n > 0 && fds[0].revents != 0) accept_one();
        panel.refresh();
        image.tick(Image::Clock::now());
      } catch (const std::exception& e) {  // no memory or no thread: the connected masters are still served
        log_error("modbus: {}", failure_text(e));
        poll(nullptr, 0, kTick_ms);
      }
    }
  }

  void accept_one() {
    sockaddr_storage peer{};
    socklen_t length = sizeof peer;
    const int fd = accept4(listener.get(), reinterpret_cast<sockaddr*>(&peer), &length, SOCK_CLOEXEC);
    if (fd < 0) {
      if (errno != EINTR && errno != EAGAIN && errno != ECONNABORTED)
        throw InputError("accept: " + system_text());
      return;
    }
    const std::string host = host_of(peer, length);
    const LogFields fields{{"client", host}};  // peers can cause these lines in masses
    const std::string refusal = why_not(host, fd);
    if (!refusal.empty()) {
      log_warning("modbus: a master at {} was refused: {}", host, refusal);
      close(fd);
      return;
    }
    Master& master = masters.emplace_back(host, fd);
    try {
      master.thread = std::jthread([this, &master] {
        const LogFields of_master{{"client", master.address}};
        serve_master(master.socket.get(), stop.get(), times, image);
        shutdown(master.socket.get(),
                 SHUT_RDWR);  // it learns of its end now; the socket is closed with the thread
        log_info("modbus: the master at {} disconnected", master.address);
        master.done = true;
      });
    } catch (...) {
      masters.pop_back();
      throw;
    }
    log_info("modbus: a master at {} connected", host);
  }

  std::string why_not(const std::string& host, int fd) const {
    if (!config.allow.empty() && !security::is_within(host, config.allow))
      return "modbus.allow does not list its address";
    if (masters.size() >= static_cast<std::size_t>(config.max_masters))
      return fmt::format("modbus.max_masters is {}", config.max_masters);
    if (!is_fit_for_libmodbus(fd)) return "the process has too many files and connections open";
    return {};
  }

  const ModbusConfig config;
  const MasterTimes times;
  net::Panel& panel;
  Image image;
  const std::string address;
  const UniqueFd listener;
  const UniqueFd stop;
  std::list<Master> masters;  ///< of run() alone; a list: masters stay where they are
  std::jthread thread;
};

std::optional<net::ReservedPort> reserve(const ModbusConfig& config) {
  if (!config.enabled) return std::nullopt;
  return net::ReservedPort(config.address, static_cast<std::uint16_t>(config.port));
}

Service::Service(const ModbusConfig& config, std::optional<net::ReservedPort> port, net::Panel& panel,
                 std::chrono::milliseconds frame_time) {
  if (!port) return;
  state_ = std::make_unique<State>(config, std::move(*port), panel, frame_time);
  log_info("modbus: on {}, unit ids 1 to {}", state_->address, panel.radars());
}

Service::~Service() = default;

const std::string& Service::address() const {
  static const std::string none;
  return state_ ? state_->address : none;
}

std::uint16_t Service::port() const {
  const std::string& text = address();
  const std::size_t colon = text.rfind(':');
  return colon == std::string::npos ? std::uint16_t{0}
                                    : static_cast<std::uint16_t>(std::stoi(text.substr(colon + 1)));
}

}  // namespace obliq::modbus
