#pragma once
// What a radar's next frame must hold, from what its watchers ask for.
#include <chrono>
#include <cstdint>
#include <vector>

#include "server/radar/receiver/receiver.h"
#include "server/radar/render.h"
#include "server/stream/stream_choice.h"

namespace obliq::rendering {

std::chrono::steady_clock::duration period_of(double rate_hz);

/// What one subscription asks of its radar.
struct Demand {
  std::uint64_t watch_id = 0;  ///< never used again
  double rate_hz = 0;
  stream::StreamChoice choice;
  bool lossless = false;                      ///< its frames may be late, but none is skipped
  std::chrono::steady_clock::time_point due;  ///< of its next frame; the render thread's own
  bool is_served() const { return due != std::chrono::steady_clock::time_point{}; }  ///< has had a frame
};

/// What must be rendered of a frame for some of the watchers.
struct Order {
  std::vector<std::uint64_t> takers;
  std::vector<stream::StreamChoice> choices;  ///< different ones
  bool iq = false;                            ///< for itself, or for the video
  bool states = false;
  bool labels = false;
  bool target_ids = false;
  bool truth = false;
  bool video8 = false;
  bool video16 = false;
  bool bins = false;                   ///< some plane of bins
  bool pulses = false;                 ///< trains of pulses
  std::vector<AzimuthRange> azimuths;  ///< whole wedges, rising, apart from one another
};

/// Copies of the demands that are due, or of those alone that have had no frame; the next date of each is
/// set.
std::vector<Demand> take_due(std::vector<Demand>& demands, std::chrono::steady_clock::time_point now,
                             bool unserved_only = false);
/// No frame was made: they are due again.
void give_back(const std::vector<Demand>& taken, std::vector<Demand>& demands);

/// What a choice needs rendered.
ReceivedPlanes needed_planes(const stream::StreamChoice& choice, const RadarSettings& settings);

/// Trains are asked for, of a radar that gives them out.
bool wants_pulses(const stream::StreamChoice& choice, const RadarSettings& settings);

/// What a frame of such settings must hold for them. A window without a bin in the frame gets nothing.
Order order_of(const std::vector<Demand>& demands, const RadarSettings& settings);

}  // namespace obliq::rendering
