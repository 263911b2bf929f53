#pragma once
// Whose turn it is to render. Pure decisions, without clock, thread or frames.
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

namespace obliq::rendering {

/// Shares rendering time among flows: the live radars, and all RenderOnce requests as one.
///
/// The share is of time, not of frames: while n flows have something to render, each gets at least one n-th
/// of the time, and what a flow does not need goes to the others. So a radar whose frames take twenty times
/// as long has fewer of them, and takes nothing from radars that stay within their shares. (Turns frame by
/// frame would give it twenty times their time; frames in proportion to rates would reward high rates.)
///
/// Weighted fair queueing with equal weights (Demers, Keshav, Shenker 1989): each piece of work, a frame or a
/// slice of one, is given the virtual time at which it would end if all flows rendered at once, each with
/// its share, and the earliest end goes first. Departures: virtual time is that of the flow that has had
/// least, as in start-time fair queueing (Goyal, Vin, Cheng 1996), so that it does not depend on how many
/// flows want something at a moment; the cost of a piece is not known beforehand, so it is estimated as 1.5
/// times the flow's last one (a new flow's: the cheapest of the others'), doubled whenever it turns out to
/// be more, and settled afterwards; and a piece may be interrupted by one with an earlier end. Flows of
/// equal cost are therefore served one whole frame after the other, and only a long frame gives way to short
/// ones.
class FairShare {
 public:
  /// Flows are numbered in the order they are added.
  std::size_t add();

  /// Whether it has something to render now. A flow that had not has no claim on the time it did not use.
  void set_wanting(std::size_t flow, bool wanting);

  /// Time has been spent on a flow's current piece.
  void charge(std::size_t flow, double seconds);
  /// That piece is done.
  void done(std::size_t flow);

  /// Virtual end of the flow's current piece, or of its next one if that began now. In seconds of
  /// rendering.
  double end_s(std::size_t flow) const;
  /// The wanting flow with the earliest end; of equal ones the lowest number.
  std::optional<std::size_t> first() const;
  /// How long a flow may go on while the other one waits, in seconds of rendering; 0: the other goes first.
  double lead_s(std::size_t flow, std::size_t other) const;

 private:
  struct Flow {
    bool wanting = false;
    double begin_s = 0;            ///< virtual, of the current piece; as much as was paid for when none is
    double spent_s = 0;            ///< on the current piece
    std::optional<double> last_s;  ///< what the last piece took
  };
  double begin_of(const Flow& flow) const;
  /// Estimated cost of the flow's current piece, or of its next one.
  double expected_s(const Flow& flow) const;

  std::vector<Flow> flows_;
  double now_s_ = 0;  ///< virtual: where a flow begins that has rested
};

/// When a radar's frames are due: every period, at dates that stay where they are however late a frame is.
class FrameDates {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  Time due() const { return due_; }
  /// The next frame is due at that time, and the others at periods from there.
  void begin_at(Time time) { due_ = time; }

  struct Taken {
    Duration late{};         ///< after its date, the newest that has passed
    std::uint64_t shed = 0;  ///< whole frames whose dates have passed as well: not rendered, now or later
  };
  /// A frame is begun: the newest that is due. `keep_all`: none is shed, they are put off.
  Taken take(Time now, Duration period, bool keep_all);

 private:
  Time due_;
};

}  // namespace obliq::rendering
