#pragma once
// Flies a radar of a running server round a course, watches it, and measures what a display would notice.
#include <cstdint>
#include <string>
#include <vector>

#include "client/socket.h"

namespace obliq::test {

/// A course of two straights and two half circles, flown clockwise, beginning eastwards along the southern
/// straight at its middle.
struct Racetrack {
  double latitude_deg = 0;  ///< of its centre
  double longitude_deg = 0;
  double straight_m = 0;
  double radius_m = 0;
  double length_m() const;

  struct Place {
    double latitude_deg = 0;
    double longitude_deg = 0;
    double bearing_deg = 0;
  };
  Place at(double flown_m) const;
};

struct FlightOrder {
  client::Endpoint server;
  std::string radar = "main";
  Racetrack course;
  double distance_m = 0;
  double speed_m_s = 0;
  double pose_rate_hz = 60;
  double frame_rate_hz = 5;
  int server_pid = 0;  ///< whose memory is read; 0: none
  bool print = false;  ///< a line every ten seconds
};

struct FlightReport {
  std::string failure;  ///< empty: flown to the end
  double flown_s = 0;
  std::uint64_t poses = 0;
  std::uint64_t frames = 0;
  std::uint64_t windows = 0;      ///< loaded in flight
  std::uint64_t origins = 0;      ///< changes of the scene's origin seen in frames
  std::uint64_t failures = 0;     ///< windows that could not be loaded
  std::uint64_t late_frames = 0;  ///< that came more than one frame time late
  double greatest_gap_s = 0;      ///< between the ends of two frames
  double median_gap_s = 0;
  double greatest_render_s = 0;
  double least_coverage = 1;
  double first_memory_mb = 0;  ///< after the first window was loaded in flight, or at the end without any
  double greatest_memory_mb = 0;
  double last_memory_mb = 0;
  std::string text() const;
};

FlightReport fly(const FlightOrder& order);

}  // namespace obliq::test
