#pragma once
#include <chrono>
#include <optional>
#include <string>

namespace obliq {

/// What the daemon tells systemd (sd_notify(3)); without a NOTIFY_SOCKET in the environment nothing happens.
/// From any thread.
namespace service_manager {

void status(const std::string& line);  ///< shown by `systemctl status`
void ready(const std::string& line);   ///< READY=1, with a status; also after reloading()
void reloading();                      ///< RELOADING=1
void stopping();                       ///< STOPPING=1
void watchdog();                       ///< WATCHDOG=1: still alive
/// How often watchdog() is expected (WatchdogSec=); nothing: never.
std::optional<std::chrono::microseconds> watchdog_period();

}  // namespace service_manager
}  // namespace obliq
