#pragma once
#include <chrono>

#include "server/modbus/image.h"

namespace obliq::modbus {

/// How long a master may take.
struct MasterTimes {
  std::chrono::duration<double> idle;  ///< between two requests
  std::chrono::milliseconds frame;  ///< from the first to the last byte of a request, and to take an answer
};

/// Serves one master until it leaves, misbehaves, takes too long, or `stop_fd` becomes readable.
/// Blocks: every master has a thread and a libmodbus context of its own. While an answer waits for a master
/// that does not read, only a shutdown of the socket ends it sooner. The caller closes the socket.
void serve_master(int socket, int stop_fd, const MasterTimes& times, Image& image);

/// True when libmodbus may be given the descriptor: it puts them into an fd_set, which ends at FD_SETSIZE.
bool is_fit_for_libmodbus(int socket);

}  // namespace obliq::modbus
