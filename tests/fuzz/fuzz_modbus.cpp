// Modbus/TCP requests to the operator's console, through the room, without sockets. The input is frames: a
// byte (bit 7: the header is taken from the input as well, else it is made right; bits 0 to 1: the unit), a
// byte of length, and that much data.
#include <spdlog/spdlog.h>

#include <array>
#include <deque>

#include "server/modbus/image.h"
#include "server/net/room.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/no_scene.h"

namespace obliq::modbus {
namespace {

std::vector<std::uint8_t> framed(std::uint8_t unit, std::span<const std::byte> data) {
  const std::size_t length = data.size() + 1;
  std::vector<std::uint8_t> frame{
      0, 1, 0, 0, static_cast<std::uint8_t>(length >> 8), static_cast<std::uint8_t>(length & 0xFF), unit};
  for (const std::byte byte : data) frame.push_back(std::to_integer<std::uint8_t>(byte));
  return frame;
}

/// All registers of a unit.
Registers registers_of(Image& image, std::uint8_t unit) {
  Request request;
  request.unit = unit;
  request.function = Function::read_holding;
  request.read = {0, 1};
  Registers registers;
  if (image.perform(request, registers) != Exception::none)
    fuzz::broken("the map's first register is not there");
  return registers;
}

void check_refused(const Registers& before, const Registers& after) {
  for (const Setpoint& setpoint : setpoints()) {
    const auto words = encode(setpoint, {}).size();
    for (std::size_t i = 0; i < words; ++i) {
      const std::size_t at = static_cast<std::size_t>(setpoint.address) + i;
      if (before.holding[at] != after.holding[at] || before.input[at] != after.input[at]) {
        fuzz::broken("a refused request has changed a setpoint");
      }
    }
  }
}

void run(fuzz::Input input) {
  const fuzz::NoScene renderer;
  std::deque<std::function<void()>> posted;
  net::Room room(renderer, {}, {fuzz::small_radar("main"), fuzz::small_radar("nose")},
                 [&posted](std::function<void()> work) { posted.push_back(std::move(work)); });
  net::Panel panel(room, [](const std::function<void()>& work) { work(); });
  Image image(panel, 1);
  while (!input.empty()) {
    const std::uint8_t choice = input.u8();
    const auto data = input.take(input.u8());
    std::vector<std::uint8_t> frame = framed(choice & 3, data);
    if ((choice & 0x80) != 0) frame.erase(frame.begin(), frame.begin() + 7);
    if (frame.size() < kHeadBytes + 1 || frame.size() > kMostBytes) continue;
    if (bytes_to_come(std::span<const std::uint8_t, kHeadBytes>(frame.data(), kHeadBytes)) !=
        frame.size() - kHeadBytes) {
      continue;
    }
    Request request;
    if (parse(frame, request) != Exception::none) continue;
    const bool masks = request.function == Function::mask_write_register;
    if (request.read.count > 2000 || request.read.count + request.write.count <= 0 ||
        (!masks && request.values.size() != static_cast<std::size_t>(request.write.count)))
      fuzz::broken("a frame is taken for more than it is");
    const bool is_there = request.unit >= 1 && request.unit <= panel.radars();
    const Registers before = is_there ? registers_of(image, request.unit) : Registers{};
    Registers registers;
    const bool refused = image.perform(request, registers) != Exception::none;
    if (refused && is_there) check_refused(before, registers_of(image, request.unit));
    if ((choice & 0x40) != 0) image.tick(Image::Clock::now());
    for (; !posted.empty(); posted.pop_front()) posted.front()();
  }
}

}  // namespace
}  // namespace obliq::modbus

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  obliq::modbus::run(obliq::fuzz::Input(data, size));
  return 0;
}
