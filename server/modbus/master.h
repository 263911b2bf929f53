#pragma once
#include <chrono>

#include "server/modbus/image.h"

namespace obliq::modbus {

/// A master that takes longer than this from the first to the last byte of a request, or to take an answer,
/// is disconnected.
constexpr std::chrono::milliseconds kFrameTime{5000};

/// Serves one master until it leaves, misbehaves, asks nothing for `idle_s`, or `stop_fd` becomes readable.
/// Blocks: every master has a thread and a libmodbus context of its own. Takes the socket over, and closes
/// it.
void serve_master(int socket, int stop_fd, double idle_s, Image& image);

/// True when libmodbus may be given the descriptor: it puts them into an fd_set, which ends at FD_SETSIZE.
bool is_fit_for_libmodbus(int socket);

}  // namespace obliq::modbus
