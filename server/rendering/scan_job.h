#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "server/rendering/live_stream.h"

namespace obliq::rendering {

struct Dwell;

/// Renders what the beam of a scanning antenna passes: each dwell with the pose of its moment, when the beam
/// is there. A pass over the sector is one frame of the stream. All watchers get every pass, whatever rate
/// they asked for.
class ScanJob : public Job {
 public:
  ScanJob(const RenderContext& context, LiveStream& stream);
  ~ScanJob() override;

  bool has_begun() const { return scan_ || work_; }
  Time date(Time now) override;
  bool work() override;
  /// The beam stops; a pass that has begun is aborted.
  void end(const std::string& reason);

 private:
  struct Pass;
  struct Scan;

  /// The next dwell, if the beam has come to its middle.
  void dwell(Time now);
  /// The beam is in the middle of the next dwell.
  void render_dwell(const LiveView& view, const std::stop_token& stop);
  /// Marks the dwells that the beam has passed as missed: in the current pass and in the one
  /// that begins with `dwell`; whole passes between are skipped.
  void leave_out(const Dwell& dwell);
  void miss(const Dwell& dwell);
  /// Some client asked for a part of these azimuths.
  bool is_wanted(const AzimuthRange& azimuths) const;
  /// To the next dwell; at the edge the pass ends.
  void advance();
  std::vector<FieldError> begin_pass(const LiveView& view, const std::vector<Demand>& demands);
  /// Plans the pass anew where the antenna has moved.
  std::vector<FieldError> plan_dwell(const LiveView& view);
  /// False when stopped.
  bool render_azimuths(const LiveView& view, const std::stop_token& stop);
  bool render_wanted(const AzimuthRange& azimuths, const RenderOptions& options) const;
  void end_pass();

  const RenderContext& context_;
  LiveStream& stream_;
  std::unique_ptr<Scan> scan_;  ///< null: the beam stands
  LiveStream::Start start_;     ///< of the current dwell, as what follows
  std::shared_ptr<const LiveView> view_;
  std::uint64_t generation_ = 0;  ///< of the renderer
  std::vector<FieldError> errors_;
  bool stopped_ = false;
  std::unique_ptr<ParkedWork> work_;  ///< null: none
};

}  // namespace obliq::rendering
