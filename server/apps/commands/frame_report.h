#pragma once
// What commands say about frames, their warnings and poses.
#include <string>
#include <vector>

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

}  // namespace obliq
