#pragma once
// A flown track as a table: time, latitude, longitude, height, bearing, line by line.
#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "terrain/base/files.h"

namespace obliq {

/// One line of it. Seconds in the track's own clock, heights above whatever the reader's user says.
struct TrackPoint {
  double time_s = 0;
  double latitude_deg = 0;
  double longitude_deg = 0;
  double height_m = 0;
  double bearing_deg = 0;
  // Of columns that a header names so; empty: not said.
  std::optional<double> velocity_north_m_s, velocity_east_m_s, velocity_up_m_s;
  std::optional<double> roll_deg, pitch_deg;
};

constexpr double kKnot_m_s = 1852.0 / 3600;  // exactly: NIST SP 811, appendix B

/// A column behind the fifth that is read.
struct MotionColumn {
  std::string_view name;       ///< exactly, in a header
  std::string_view parameter;  ///< whose limits it has
  std::optional<double> TrackPoint::*value;
  double unit = 1;  ///< of the column, in the parameter's
};
inline constexpr std::array<MotionColumn, 8> kMotionColumns{{
    {"velocity_north_m_s", "antenna.velocity_north_m_s", &TrackPoint::velocity_north_m_s},
    {"velocity_east_m_s", "antenna.velocity_east_m_s", &TrackPoint::velocity_east_m_s},
    {"velocity_up_m_s", "antenna.velocity_up_m_s", &TrackPoint::velocity_up_m_s},
    {"velocity_north_kt", "antenna.velocity_north_m_s", &TrackPoint::velocity_north_m_s, kKnot_m_s},
    {"velocity_east_kt", "antenna.velocity_east_m_s", &TrackPoint::velocity_east_m_s, kKnot_m_s},
    {"velocity_up_kt", "antenna.velocity_up_m_s", &TrackPoint::velocity_up_m_s, kKnot_m_s},
    {"roll_deg", "antenna.roll_deg", &TrackPoint::roll_deg},
    {"pitch_deg", "antenna.pitch_deg", &TrackPoint::pitch_deg},
}};

/// Lines of comma-separated numbers, of which those behind the fifth are passed by, but for kMotionColumns,
/// where a header names them; so are empty lines and those that begin with #. A first line that is no number
/// is a header and must name the first five columns in that order; a unit in the name of the height
/// (height_ft, "alt [m]") is that of its numbers. Throws InputError "FILE:LINE: column: found ...; allowed:
/// ..." on anything else, a time that goes back included.
class TrackReader {
 public:
  /// "-": standard input. height_unit_m: of heights whose column names no unit.
  explicit TrackReader(const std::string& path, double height_unit_m = 1);

  enum class Got { point, end, nothing_yet };
  /// The next point, waiting at most so long for what has not been written yet.
  Got next(TrackPoint& point, std::chrono::milliseconds patience);

  /// "FILE:LINE" of the newest point.
  std::string where() const;
  /// A file can be read through before it is flown, a pipe cannot.
  bool is_file() const { return is_file_; }
  void rewind();

 private:
  Got next_line(std::string& line, std::chrono::milliseconds patience);
  bool parse(std::string_view line, TrackPoint& point);
  void read_header(std::string_view line);
  void read_motion(std::string_view rest, TrackPoint& point) const;

  std::string name_;
  UniqueFd fd_;
  bool is_file_ = false;
  const double usual_height_unit_m_;
  double height_unit_m_;
  std::string read_;          ///< and not taken yet
  std::size_t searched_ = 0;  ///< of it, without a line's end
  bool ended_ = false;
  std::uint64_t line_ = 0;
  bool begun_ = false;     ///< a header or a point has come
  bool flying_ = false;    ///< a point has come
  bool is_track_ = false;  ///< a header or a point was read: what the file says may be shown
  double last_time_s_ = 0;
  std::vector<const MotionColumn*> behind_;  ///< each column behind the fifth; null: passed by
};

}  // namespace obliq
