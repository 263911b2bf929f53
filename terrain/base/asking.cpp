#include "terrain/base/asking.h"

#include <utility>

namespace obliq {

constinit thread_local asking::Count asking::count = asking::kUnheard;

void asking::pass() {
  WorkGate* const gate = count.gate;
  if (gate == nullptr) {
    count = kUnheard;
    return;
  }
  const std::int64_t look = gate->look();
  const std::int64_t work = look - std::exchange(count.left, look);
  gate->pass(work);
}

BehindGate::BehindGate(WorkGate* gate) : before_(asking::count) {
  if (gate != nullptr) gate->enter();
  asking::count = gate == nullptr ? asking::kUnheard : asking::Count{gate->look(), gate};
}

BehindGate::~BehindGate() {
  if (asking::count.gate != nullptr) asking::count.gate->leave();
  asking::count = before_;
}

OutsideGate::OutsideGate() : gate_(asking::count.gate) {
  if (gate_ != nullptr) gate_->leave();
}

OutsideGate::~OutsideGate() {
  if (gate_ != nullptr) gate_->enter();
}

}  // namespace obliq
