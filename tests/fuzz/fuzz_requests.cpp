// Every message that a client may send, through the room that answers them, without sockets and without a
// scene. The input is requests: a byte (bit 7: of the second client), the type, two bytes of length, and that
// much protobuf.
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <deque>
#include <memory>
#include <mutex>

#include "proto/obliq.pb.h"
#include "server/net/peer.h"
#include "server/net/room.h"
#include "tests/fuzz/input.h"
#include "tests/fuzz/no_scene.h"

namespace obliq::net {
namespace {

using wire::MessageType;

/// Counts what it is sent and takes it at once.
class Listener : public Peer {
 public:
  explicit Listener(std::uint64_t number)
      : Peer(number, "127.0.0.1", "127.0.0.1:" + std::to_string(number), false, 2, std::size_t{1} << 20) {
    name = address;
  }
  void send(MessageType type, const google::protobuf::Message& message,
            std::span<const std::byte> plane) override {
    stream::BlockPtr block = stream::block_for_one(type, {0, ++sent, 0}, message, takes_json, plane);
    if (block->bytes.empty()) fuzz::broken("an answer does not encode");
    outbox.push_control(std::move(block));
  }
  void kick() override {}
  void fail(wire::ErrorNumber, const std::string&) override { failed = true; }
  void finish(wire::ErrorNumber, const std::string&) override { failed = true; }
  void drop() override { failed = true; }

  std::uint64_t sent = 0;
  bool failed = false;
};

bool is_answered(MessageType type) {
  constexpr std::array kAnswered{
      MessageType::list_radars,     MessageType::get_radar,    MessageType::claim_control,
      MessageType::release_control, MessageType::set_settings, MessageType::set_pose,
      MessageType::set_state,       MessageType::subscribe,    MessageType::unsubscribe,
      MessageType::render_once,     MessageType::get_status,   MessageType::set_replay,
      MessageType::reset_exercise,  MessageType::get_exercise, MessageType::load_exercise,
      MessageType::set_exercise,    MessageType::get_events,   MessageType::add_bookmark};
  return std::find(kAnswered.begin(), kAnswered.end(), type) != kAnswered.end();
}

/// What is to run on the io thread; ground queries come from a thread of their own.
class Posted {
 public:
  void add(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(work));
  }
  /// Empty: there is nothing.
  std::function<void()> take() {
    const std::lock_guard lock(mutex_);
    if (waiting_.empty()) return {};
    auto first = std::move(waiting_.front());
    waiting_.pop_front();
    return first;
  }

 private:
  std::mutex mutex_;
  std::deque<std::function<void()>> waiting_;
};

void greet(Room& room, Listener& peer) {
  wire::Hello hello;
  hello.set_major(wire::kMajorVersion);
  hello.set_client_name("fuzz");
  const std::string bytes = hello.SerializeAsString();
  room.handle(peer, MessageType::hello, std::as_bytes(std::span(bytes)));
  if (!peer.greeted) fuzz::broken("a client is not greeted");
}

void run(fuzz::Input input) {
  const fuzz::NoScene renderer;
  Posted posted;
  ServerOptions options;
  options.query_ground = [](const GroundQuestion& question, const std::stop_token&) {
    GroundAnswers answers;
    answers.records.resize(question.points());
    return answers;
  };
  Room room(renderer, options, {fuzz::small_radar("main"), fuzz::small_radar("nose")},
            [&posted](std::function<void()> work) { posted.add(std::move(work)); });
  const std::array peers{std::make_shared<Listener>(1), std::make_shared<Listener>(2)};
  for (const auto& peer : peers) {
    room.enter(peer);
    greet(room, *peer);
  }
  while (!input.empty()) {
    Listener& peer = *peers[input.u8() >> 7];
    const auto type = static_cast<MessageType>(input.u8());
    const auto descriptor = input.take(input.u16());
    if (peer.failed) continue;
    const std::uint64_t before = peer.sent;
    room.handle(peer, type, descriptor);
    if (is_answered(type) && peer.sent == before && !peer.failed) fuzz::broken("a request without an answer");
    while (const stream::BlockPtr block = peer.outbox.pop()) room.taken(peer, *block);
    while (const auto work = posted.take()) work();
  }
  for (const auto& peer : peers) room.leave(peer);
  while (const auto work = posted.take()) work();
}

}  // namespace
}  // namespace obliq::net

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const obliq::fuzz::QuietProtobuf quiet;
  spdlog::set_level(spdlog::level::off);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  obliq::net::run(obliq::fuzz::Input(data, size));
  return 0;
}
