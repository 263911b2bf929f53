#include "server/apps/daemon/service_manager.h"

#include <fmt/core.h>
#include <systemd/sd-daemon.h>

#include <ctime>

#include "terrain/base/text.h"

namespace obliq::service_manager {
namespace {

void tell(const std::string& state) {
  (void)sd_notify(0, state.c_str());
}  // fails where no service manager is

}  // namespace

void status(const std::string& line) { tell("STATUS=" + one_line(line)); }

void ready(const std::string& line) { tell("READY=1\nSTATUS=" + one_line(line)); }

void reloading() {
  // systemd 253 and later want to know since when (Type=notify-reload).
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  tell(fmt::format("RELOADING=1\nSTATUS=reloading\nMONOTONIC_USEC={}",
                   now.tv_sec * 1'000'000LL + now.tv_nsec / 1000));
}

void stopping() { tell("STOPPING=1\nSTATUS=stopping"); }

void watchdog() { tell("WATCHDOG=1"); }

std::optional<std::chrono::microseconds> watchdog_period() {
  std::uint64_t period_us = 0;
  if (sd_watchdog_enabled(0, &period_us) <= 0) return std::nullopt;
  return std::chrono::microseconds(period_us);
}

}  // namespace obliq::service_manager
