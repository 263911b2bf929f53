#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>

#include "server/apps/commands/fly/datagram_inbox.h"
#include "server/apps/dis/entity_state.h"
#include "server/apps/dis/pdu_clock.h"

namespace obliq {

class FlyNews;
struct DatagramSource;

/// The datagrams of `obliq fly`: from where its options say, each PDU of DIS with its time.
class PduSource {
 public:
  using Time = PduClock::Time;
  /// stamped: when what it says was so, by --clock.
  using Taker = std::function<void(const Pdu& pdu, Time stamped, Time arrived)>;

  /// Says on the standard output that it listens, and where: "NAME: listening on ...". Throws InputError.
  PduSource(const DatagramSource& source, const std::string& name);

  /// All that have come, or come before so long: PDUs of the exercise go to the taker, what is none to the
  /// news.
  void take(std::chrono::milliseconds longest, FlyNews& news, const Taker& taker);
  /// The datagrams as they are.
  Datagrams take(std::chrono::milliseconds longest) { return inbox_.take(longest); }
  /// ", 3 datagrams lost ...": buffers were full, here or in the kernel.
  std::string losses() const;
  /// "1 PDU understood": all that went to the taker.
  std::string understood() const;

 private:
  const DatagramSource& source_;
  DatagramInbox inbox_;
  PduClock clock_;
  std::uint64_t understood_ = 0;
};

}  // namespace obliq
