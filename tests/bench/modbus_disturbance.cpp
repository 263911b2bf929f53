// How much ill-behaved masters disturb a good one: the good one's time for a question and its answer, alone
// and beside each kind, in turns so that the machine's own load is in all of them.
//
//   modbus_disturbance [SECONDS]      per kind; default 10
#include <spdlog/spdlog.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <thread>
#include <vector>

#include "tests/integration/modbus_fixture.h"

namespace obliq::test {
namespace {

using Clock = std::chrono::steady_clock;

struct Kind {
  const char* name;
  std::function<void(RawMaster&, const std::atomic<bool>& stop)> behave;
};

const Octets kQuestion{4, 0, 100, 0, 22};

void nothing(RawMaster&, const std::atomic<bool>&) {}

void byte_at_a_time(RawMaster& master, const std::atomic<bool>& stop) {
  const Octets frame = frame_of(kQuestion, 1, 0);
  while (!stop) {
    for (const std::uint8_t byte : frame) {
      master.send({byte});
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    master.receive();
  }
}

void malformed(RawMaster& master, const std::atomic<bool>& stop) {
  while (!stop) {
    master.ask({16, 0, 254, 0, 2, 2, 0, 1});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void out_of_limits(RawMaster& master, const std::atomic<bool>& stop) {
  while (!stop) {
    master.write(250, {9});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

void applies(RawMaster& master, const std::atomic<bool>& stop) {
  for (std::uint16_t bins = 16; !stop; bins = static_cast<std::uint16_t>(bins % 32 + 16)) {
    master.write(254, {bins});
    master.coil(2, true);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// Times of a question each millisecond, in ms.
std::vector<double> times_ms(RawMaster& good, double seconds) {
  std::vector<double> times;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (Clock::now() < end) {
    const auto start = Clock::now();
    good.ask(kQuestion);
    times.push_back(std::chrono::duration<double, std::milli>(Clock::now() - start).count());
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return times;
}

double quantile(std::vector<double> times, double q) {
  std::ranges::sort(times);
  return times[static_cast<std::size_t>(q * static_cast<double>(times.size() - 1))];
}

void measure(double seconds) {
  const std::vector<Kind> kinds{{"alone", nothing},
                                {"a byte each 20 ms", byte_at_a_time},
                                {"malformed, 1 kHz", malformed},
                                {"out of limits, 1 kHz", out_of_limits},
                                {"apply, 1 kHz", applies}};
  std::vector<std::vector<double>> times(kinds.size());
  ModbusServer server;
  RawMaster good(server.service.port());
  for (double passed = 0; passed < seconds; passed += 1) {
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      RawMaster bad(server.service.port());
      std::atomic<bool> stop = false;
      std::jthread thread([&] { kinds[k].behave(bad, stop); });
      const std::vector<double> more = times_ms(good, 1);
      stop = true;
      times[k].insert(times[k].end(), more.begin(), more.end());
    }
  }
  std::printf("%-22s %9s %9s %9s %9s %9s\n", "beside", "questions", "median ms", "99 %", "99.9 %", "longest");
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    std::printf("%-22s %9zu %9.3f %9.3f %9.3f %9.3f\n", kinds[k].name, times[k].size(),
                quantile(times[k], 0.5), quantile(times[k], 0.99), quantile(times[k], 0.999),
                quantile(times[k], 1));
  }
}

}  // namespace
}  // namespace obliq::test

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::err);
  obliq::test::measure(argc > 1 ? std::atof(argv[1]) : 10);
}
