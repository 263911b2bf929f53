#pragma once
// What render and get say about a frame that has been written.
#include <string>
#include <vector>

namespace obliq::wire {
class FrameDescriptor;
class FrameSummary;
}  // namespace obliq::wire

namespace obliq {

/// The frame's warnings, a line each on stderr, and one line on stdout: where its files are, rays, samples,
/// `times` in the caller's words, buildings seen. Warnings that have been `said` are not said again.
void print_frame_report(const std::string& out, const wire::FrameDescriptor& descriptor,
                        const wire::FrameSummary& summary, const std::string& times,
                        const std::vector<std::string>& said = {});

/// "12 ms".
std::string milliseconds_text(double seconds);

}  // namespace obliq
