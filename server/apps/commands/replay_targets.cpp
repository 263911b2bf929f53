#include "server/apps/commands/replay_targets.h"

#include <fmt/core.h>

#include <cstdio>
#include <filesystem>
#include <memory>

#include "proto/obliq.pb.h"
#include "server/apps/commands/arguments/server_arguments.h"
#include "server/apps/commands/commands.h"
#include "server/output/frame_files.h"
#include "server/radar/targets/seen_share.h"
#include "terrain/base/errors.h"
#include "terrain/base/text.h"

namespace obliq {

void write_targets(const std::string& recording, const client::RecordingStart& start,
                   const std::string& out) {
  std::unique_ptr<client::RecordingReader> reader;
  require(client::RecordingReader::open(recording, reader));
  client::RecordedFrames frames(std::move(reader), start.radar, start.planes);
  std::string text =
      "frame,utc_ns,sim_time_ns,id,latitude_deg,longitude_deg,height_m,bearing_deg,range_m,elevation_deg,"
      "closing_m_s,"
      "snr_db,is_power,rcs_dbsm,share_seen,azimuth_bin,range_bin,hidden_by\n";
  std::uint64_t lines = 0, shown = 0;
  for (client::RecordedFrame recorded;;) {
    const auto found = frames.next(recorded);
    if (found == client::RecordedFrames::Found::end) break;
    if (found != client::RecordedFrames::Found::frame) continue;
    ++shown;
    for (const wire::TargetRecord& t : recorded.frame.targets) {
      text += fmt::format(
          "{},{},{},{},{:.9f},{:.9f},{:.3f},{:.6f},{:.3f},{:.6f},{:.3f},{:.3f},{},{:.3f},{"
          ":.4f},{},{},{}\n",
          recorded.frame.descriptor->frame_id(), recorded.begin_utc_ns,
          recorded.frame.descriptor->pose().sim_time_ns(), t.id, t.latitude_deg, t.longitude_deg, t.height_m,
          t.bearing_deg, t.range_m, t.elevation_deg, t.closing_m_s, t.snr_db, t.is_power ? 1 : 0, t.rcs_dbsm,
          t.share_seen, t.azimuth_bin, t.range_bin, name_of(static_cast<HiddenBy>(t.hidden_by)));
      ++lines;
    }
  }
  if (lines == 0)
    throw InputError(recording + ": none of its " + counted(shown, "frame") +
                     " says where targets are; `obliq record --truth` keeps it, where the server allows it");
  if (out == "-") {
    std::fputs(text.c_str(), stdout);
  } else {
    std::error_code none;
    if (std::filesystem::equivalent(recording, out, none))
      throw InputError("--targets: found the recording itself; allowed: another file, or -");
    write_text(out, text);
    std::printf("%s: %s of %s\n", out.c_str(), counted(lines, "line").c_str(),
                counted(shown, "frame").c_str());
  }
  if (frames.losses().any()) throw PartlyDone(recording + ": " + frames.losses().text());
}

}  // namespace obliq
