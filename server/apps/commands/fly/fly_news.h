#pragma once
#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "server/apps/dis/refused_datagrams.h"

namespace obliq {

/// What `obliq fly` has to say of what comes: on the standard error, in at most one line a second, whatever
/// comes. What is the same as before is told once.
class FlyNews {
 public:
  /// Between two lines.
  static constexpr std::chrono::milliseconds kPause{1000};

  void add(std::string text);
  /// A datagram that is none.
  void refuse(const std::string& why) { refused_.add(why); }
  /// Of an Ack: tells those that the one before had not.
  void hear(std::vector<std::string> warnings);

  /// Lines about anything but datagrams come first.
  void tell_what_is_due();
  void tell_the_rest();
  std::uint64_t refused() const { return refused_.all(); }

 private:
  void tell_news();

  RefusedDatagrams refused_;
  std::vector<std::string> news_, warnings_;
  std::chrono::steady_clock::time_point next_{};
};

}  // namespace obliq
