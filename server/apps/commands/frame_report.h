#pragma once
// What commands say about frames, their warnings and poses.
#include <string>
#include <vector>

#include "client/frame_assembler.h"
#include "server/output/ground_map_png.h"
#include "server/radar/pulse_train.h"

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
class Pose;
}  // namespace obliq::wire

namespace obliq {

/// The frame's warnings, a line each on stderr, and one line on stdout: where its files are, rays, samples,
/// `times` in the caller's words, buildings seen. Warnings that have been `said` are not said again.
void print_frame_report(const std::string& out, const wire::FrameDescriptor& descriptor,
                        const wire::FrameSummary& summary, const std::string& times,
                        const std::vector<std::string>& said = {});

/// "12 ms".
std::string milliseconds_text(double seconds);

/// Position and bearing of an antenna.
std::string pose_text(const wire::Pose& pose);

/// Reports on stderr when a warning begins and when it is over. Two that differ in their numbers only are the
/// same one.
class WarningChanges {
 public:
  /// All that hold now. `where`: the beginning of each line, such as "FILE:7: ".
  void tell(std::vector<std::string> now, const std::string& where = {});

 private:
  std::vector<std::string> held_;
};

/// Keeps a folder that always holds the files of the newest frame, for watch and replay. What a frame's files
/// lack is told on stderr, once as long as it stays the same.
class NewestFiles {
 public:
  /// Makes the folder. Throws InputError.
  NewestFiles(std::string folder, const PictureOptions& picture);
  /// Throws InputError.
  void write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary, const BinBlock& bins,
             std::vector<PulseTrain> trains);

 private:
  std::string folder_;
  PictureOptions picture_;
  SteadyScale scale_;
  std::string missing_;  ///< as it was told
};

/// Keeps a picture of the newest frame.
class NewestPicture {
 public:
  /// Makes the file's folder. Throws InputError.
  NewestPicture(std::string file, const PictureOptions& picture);
  /// time: of the frame, for its caption. Throws InputError.
  void write(const wire::FrameDescriptor& descriptor, const wire::FrameSummary& summary, const BinBlock& bins,
             const std::string& time);

 private:
  std::string file_;
  PictureOptions picture_;
  SteadyScale scale_;
};

/// A received frame's planes as the file writer takes them; they are moved out of the frame.
BinBlock take_bins(client::AssembledFrame& frame);
/// Its trains of pulses, moved out of it.
std::vector<PulseTrain> take_trains(client::AssembledFrame& frame);

}  // namespace obliq
