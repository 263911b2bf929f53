#pragma once
// What carries the messages of one connection: what the session reads and writes.
#include <cstddef>
#include <functional>
#include <span>
#include <string>

#include "proto/error_number.h"
#include "proto/limits.h"

namespace obliq::stream {
struct Block;
}

namespace obliq::net {

/// On the io thread. One reader and one writer at a time; `done` is called later, and until then the
/// transport and the bytes must live.
class Transport {
 public:
  enum class Start {
    ready,
    plain_peer,  ///< the peer does not speak TLS where it must: what follows is sent in plain
    failed,
  };
  enum class Transfer {
    done,
    end,  ///< the peer has closed
    failed,
    refused,  ///< of a read, once: what the peer sent cannot be a message, see fault(); the rest is discarded
  };
  using Started = std::function<void(Start)>;
  using Done = std::function<void(Transfer)>;

  Transport() = default;
  virtual ~Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;

  /// "127.0.0.1" (to a listener of IPv6 "::ffff:127.0.0.1"), or "?" when the peer has gone already.
  virtual std::string host() const = 0;
  virtual std::string address() const = 0;  ///< "127.0.0.1:50000"

  /// First of all. Has no time limit of its own: close() ends it.
  virtual void start(Started done) = 0;
  virtual bool is_ready() const = 0;
  /// Why start() failed; of a session that runs, what protects it.
  virtual std::string description() const = 0;

  /// How long the next message may be: where a transport takes it as a whole.
  virtual void expect(const wire::MessageLimits&) {}
  /// Fills the buffer, or with `some` a part of it.
  virtual void read(std::span<std::byte> bytes, bool some, Done done) = 0;
  struct Fault {
    wire::ErrorNumber number = wire::ErrorNumber::none;
    std::string text;
  };
  /// Why a read was refused.
  virtual Fault fault() const { return {}; }
  /// The peer reads descriptors as JSON.
  virtual bool takes_json() const { return false; }
  virtual void write(const stream::Block& message, Done done) = 0;
  /// Tells the peer that nothing more comes, after everything has been written.
  virtual void finish(Done done) = 0;
  /// Ends all of the above at once.
  virtual void close() = 0;
};

}  // namespace obliq::net
