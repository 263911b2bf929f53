#include "server/apps/commands/replay_track.h"

#include <fmt/core.h>

#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <utility>

#include "client/recording/recording_reader.h"
#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/apps/replay/recorded_time.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

const char* name_of(wire::HeightReference reference) {
  switch (reference) {
    case wire::GROUND:
      return "ground";
    case wire::ELLIPSOID:
      return "ellipsoid";
    default:
      return "datum";
  }
}

bool same_place(const wire::Pose& a, const wire::Pose& b) {
  return a.latitude_deg() == b.latitude_deg() && a.longitude_deg() == b.longitude_deg() &&
         a.height_m() == b.height_m() && a.bearing_deg() == b.bearing_deg() &&
         a.height_reference() == b.height_reference();
}

/// A line for each pose; of an antenna that stands, the first and the last.
class TrackWriter {
 public:
  explicit TrackWriter(const std::string& path)
      : file_(path == "-" ? stdout : std::fopen(path.c_str(), "w"),
              path == "-" ? +[](std::FILE*) { return 0; } : &std::fclose) {
    if (!file_)
      throw InputError(fmt::format("--track: {}: cannot be written: {}", path, std::strerror(errno)));
    std::fprintf(file_.get(),
                 "time,latitude,longitude,height,bearing,tilt,height_reference,utc_ns,sim_time_ns,pose_id,"
                 "velocity_north_m_s,velocity_east_m_s,velocity_up_m_s,roll_deg,pitch_deg\n");
  }

  void add(std::int64_t utc_ns, const wire::Pose& pose) {
    Point point{1e-9 * static_cast<double>(time_.at(utc_ns)), utc_ns, pose};
    if (written_ && point.time_s <= written_->time_s) return;  // of two planes, or a clock that was set
    if (written_ && same_place(written_->pose, pose)) {
      waiting_ = std::move(point);
      return;
    }
    flush();
    write(std::move(point));
  }
  /// The last of an antenna that stands.
  void flush() {
    if (waiting_) write(std::move(*std::exchange(waiting_, std::nullopt)));
  }
  void finish(const std::string& path) {
    flush();
    if (std::fflush(file_.get()) != 0 || std::ferror(file_.get()) != 0)
      throw InputError(fmt::format("--track: {}: cannot be written: {}", path, std::strerror(errno)));
  }
  std::uint64_t lines() const { return lines_; }
  double last_s() const { return written_ ? written_->time_s : 0; }

 private:
  struct Point {
    double time_s;
    std::int64_t utc_ns;
    wire::Pose pose;
  };
  void write(Point point) {
    const wire::Pose& pose = point.pose;
    const std::string velocity = !pose.has_velocity_north_m_s()
                                     ? ",,"  // not known
                                     : fmt::format("{:.4f},{:.4f},{:.4f}", pose.velocity_north_m_s(),
                                                   pose.velocity_east_m_s(), pose.velocity_up_m_s());
    std::fputs(
        fmt::format("{:.6f},{:.10f},{:.10f},{:.4f},{:.7f},{:.7f},{},{},{},{},{},{:.6f},{:.6f}\n",
                    point.time_s, pose.latitude_deg(), pose.longitude_deg(), pose.height_m(),
                    pose.bearing_deg(), pose.tilt_deg(), name_of(pose.height_reference()), point.utc_ns,
                    pose.sim_time_ns(), pose.pose_id(), velocity, pose.roll_deg(), pose.pitch_deg())
            .c_str(),
        file_.get());
    ++lines_;
    written_ = std::move(point);
  }

  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  RecordedTime time_;
  std::optional<Point> written_;
  std::optional<Point> waiting_;
  std::uint64_t lines_ = 0;
};

/// Looks at each message for a pose and its time.
class Poses {
 public:
  Poses(std::string radar, TrackWriter& to) : radar_(std::move(radar)), to_(to) {}

  void take(const wire::MessageView& message) {
    if (message.header.type == wire::MessageType::frame_begin) {
      wire::FrameBegin begin;
      if (!wire::parse_descriptor(message.descriptor, begin)) return;
      const bool is_ours = begin.frame().radar() == radar_;
      if (is_ours) stream_ = message.header.stream_id;
      // The pose of a whole frame is that of its beginning; a pass has one for each dwell.
      scans_ = begin.has_scan();
      if (is_ours && !scans_) to_.add(message.header.utc_ns, begin.frame().pose());
    } else if (message.header.type == wire::MessageType::wedge_block && scans_ &&
               message.header.stream_id == stream_) {
      wire::WedgeBlock block;
      if (!wire::parse_descriptor(message.descriptor, block) || block.beam_ns() == beam_ns_) return;
      beam_ns_ = block.beam_ns();
      // PROTOCOL.md, "Latency".
      std::int64_t age_ns = 0, utc_ns = 0;
      if (__builtin_sub_overflow(block.send_ns(), block.beam_ns(), &age_ns) ||
          __builtin_sub_overflow(message.header.utc_ns, age_ns, &utc_ns))
        return;
      to_.add(utc_ns, block.pose());
    }
  }

 private:
  std::string radar_;
  TrackWriter& to_;
  std::optional<std::uint32_t> stream_;
  bool scans_ = false;
  std::int64_t beam_ns_ = 0;
};

}  // namespace

void write_track(const std::string& recording, const std::string& radar, const std::string& out) {
  std::unique_ptr<client::RecordingReader> reader;
  require(client::RecordingReader::open(recording, reader));
  TrackWriter track(out);
  Poses poses(radar, track);
  std::uint64_t damages = 0;
  for (;;) {
    const auto found = reader->next();
    if (found == client::RecordingReader::Found::end) break;
    if (found == client::RecordingReader::Found::damage) {
      ++damages;
      std::fprintf(stderr, "warning: damaged at offset %llu: %s\n",
                   static_cast<unsigned long long>(reader->fault().offset), reader->fault().reason.c_str());
    } else {
      poses.take(reader->message());
    }
  }
  track.finish(out);
  if (out != "-")
    std::printf("%s: %llu poses of radar %s over %.3f s\n", out.c_str(),
                static_cast<unsigned long long>(track.lines()), radar.c_str(), track.last_s());
  if (damages > 0)
    throw PartlyDone(fmt::format("{}: damaged in {} place{}; the track has all poses that are whole",
                                 recording, damages, damages == 1 ? "" : "s"));
}

}  // namespace obliq
