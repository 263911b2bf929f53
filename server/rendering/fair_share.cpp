#include "server/rendering/fair_share.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace obliq::net {
namespace {

/// While no cost is known, a new party gets this long to show that it is quick. Slower ones are then served
/// one after the other, as if all cost the same.
constexpr double kTrial_s = 0.05;
constexpr double kUnknown_s = 1;
/// The cost of one party's pieces varies by this factor on a shared machine: none should be interrupted just
/// before its end.
constexpr double kMargin = 1.5;
constexpr double kLeast_s = 1e-3;

}  // namespace

std::size_t FairShare::add() {
  parties_.emplace_back();
  return parties_.size() - 1;
}

double FairShare::begin_of(const Party& party) const {
  return party.wanting ? party.begin_s : std::max(now_s_, party.begin_s);
}

double FairShare::expected_s(const Party& party) const {
  std::optional<double> like_s = party.last_s;
  if (!like_s)
    for (const Party& other : parties_)
      if (other.last_s) like_s = std::min(like_s.value_or(kUnknown_s), *other.last_s);
  if (!like_s && party.spent_s < kTrial_s) return kTrial_s;
  double expected_s = std::max(kLeast_s, kMargin * like_s.value_or(kUnknown_s));
  while (expected_s < party.spent_s) expected_s *= 2;
  return expected_s;
}

void FairShare::set_wanting(std::size_t number, bool wanting) {
  Party& party = parties_[number];
  if (party.wanting == wanting) return;
  if (wanting) {
    party.begin_s = begin_of(party);
  } else {
    party.begin_s += party.spent_s;
    party.spent_s = 0;
  }
  party.wanting = wanting;
}

void FairShare::charge(std::size_t party, double seconds) {
  parties_[party].spent_s += seconds;
  // The wanting party that has had least.
  double least_s = std::numeric_limits<double>::infinity();
  for (const Party& p : parties_)
    if (p.wanting) least_s = std::min(least_s, p.begin_s + p.spent_s);
  if (std::isfinite(least_s)) now_s_ = std::max(now_s_, least_s);
}

void FairShare::done(std::size_t number) {
  Party& party = parties_[number];
  party.last_s = party.spent_s;
  party.begin_s += party.spent_s;
  party.spent_s = 0;
}

double FairShare::end_s(std::size_t number) const {
  const Party& party = parties_[number];
  return begin_of(party) + expected_s(party);
}

std::optional<std::size_t> FairShare::first() const {
  std::optional<std::size_t> first;
  for (std::size_t k = 0; k < parties_.size(); ++k)
    if (parties_[k].wanting && (!first || end_s(k) < end_s(*first))) first = k;
  return first;
}

double FairShare::lead_s(std::size_t number, std::size_t other) const {
  if (end_s(other) < end_s(number)) return 0;
  return expected_s(parties_[number]) - parties_[number].spent_s;
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

}  // namespace obliq::net
