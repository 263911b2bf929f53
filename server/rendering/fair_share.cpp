#include "server/rendering/fair_share.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq::rendering {
namespace {

/// While no cost is known, a new flow gets this long to show that it is quick. Slower ones are then served
/// one after the other, as if all cost the same.
constexpr double kTrial_s = 0.05;
constexpr double kUnknown_s = 1;
/// The cost of one flow's pieces varies by this factor on a shared machine: none should be interrupted just
/// before its end.
constexpr double kMargin = 1.5;
constexpr double kLeast_s = 1e-3;

}  // namespace

std::size_t FairShare::add() {
  flows_.emplace_back();
  return flows_.size() - 1;
}

double FairShare::begin_of(const Flow& flow) const {
  return flow.wanting ? flow.begin_s : std::max(now_s_, flow.begin_s);
}

double FairShare::expected_s(const Flow& flow) const {
  std::optional<double> like_s = flow.last_s;
  if (!like_s)
    for (const Flow& other : flows_)
      if (other.last_s) like_s = std::min(like_s.value_or(kUnknown_s), *other.last_s);
  if (!like_s && flow.spent_s < kTrial_s) return kTrial_s;
  double expected_s = std::max(kLeast_s, kMargin * like_s.value_or(kUnknown_s));
  while (expected_s < flow.spent_s) expected_s *= 2;
  return expected_s;
}

void FairShare::set_wanting(std::size_t number, bool wanting) {
  Flow& flow = flows_[number];
  if (flow.wanting == wanting) return;
  if (wanting) {
    flow.begin_s = begin_of(flow);
  } else {
    flow.begin_s += flow.spent_s;
    flow.spent_s = 0;
  }
  flow.wanting = wanting;
}

void FairShare::charge(std::size_t flow, double seconds) {
  flows_[flow].spent_s += seconds;
  // The wanting flow that has had least.
  double least_s = std::numeric_limits<double>::infinity();
  for (const Flow& p : flows_)
    if (p.wanting) least_s = std::min(least_s, p.begin_s + p.spent_s);
  if (std::isfinite(least_s)) now_s_ = std::max(now_s_, least_s);
}

void FairShare::done(std::size_t number) {
  Flow& flow = flows_[number];
  flow.last_s = flow.spent_s;
  flow.begin_s += flow.spent_s;
  flow.spent_s = 0;
}

double FairShare::end_s(std::size_t number) const {
  const Flow& flow = flows_[number];
  return begin_of(flow) + expected_s(flow);
}

std::optional<std::size_t> FairShare::first() const {
  std::optional<std::size_t> first;
  for (std::size_t k = 0; k < flows_.size(); ++k)
    if (flows_[k].wanting && (!first || end_s(k) < end_s(*first))) first = k;
  return first;
}

double FairShare::lead_s(std::size_t number, std::size_t other) const {
  if (end_s(other) < end_s(number)) return 0;
  return expected_s(flows_[number]) - flows_[number].spent_s;
}

FrameDates::Taken FrameDates::take(Time now, Duration period, bool keep_all) {
  Taken taken;
  taken.late = std::max(Duration::zero(), now - due_);
  if (keep_all) {
    due_ = std::max(due_ + period, now);
    return taken;
  }
  taken.shed = static_cast<std::uint64_t>(taken.late / period);
  const Duration passed = period * static_cast<Duration::rep>(taken.shed);
  taken.late -= passed;
  due_ += passed + period;
  return taken;
}

}  // namespace obliq::rendering
