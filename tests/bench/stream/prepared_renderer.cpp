#include "tests/bench/stream/prepared_renderer.h"

#include <utility>

#include "proto/obliq.pb.h"
#include "server/control/settings_message.h"

namespace obliq::bench {
namespace {

class PreparedFrame : public rendering::PlannedFrame {
 public:
  PreparedFrame(SettingsPtr settings, Wedge& wedge) : settings_(std::move(settings)), wedge_(wedge) {}
  void describe(const std::string& radar, wire::FrameDescriptor& descriptor) const override {
    descriptor.set_radar(radar);
    write_message(settings_->settings, *descriptor.mutable_settings());
  }
  bool render(AzimuthRange azimuths, const RenderOptions& options) const override {
    for (int first = azimuths.first; first < azimuths.first + azimuths.count; first += kWedgeAzimuthBins) {
      if (options.stop.stop_requested()) return false;
      wedge_.index = first / kWedgeAzimuthBins;
      wedge_.bins.first_azimuth = first;
      options.on_wedge(std::move(wedge_));  // who receives it reads only
    }
    return true;
  }
  void summarise(const FrameStats&, wire::FrameSummary&) const override {}

 private:
  SettingsPtr settings_;
  Wedge& wedge_;
};

}  // namespace

PreparedRenderer::PreparedRenderer(int range_bins) {
  wedge_.bins = BinBlock(0, kWedgeAzimuthBins, range_bins);
  for (std::size_t i = 0; i < wedge_.bins.iq.size(); ++i)
    wedge_.bins.iq[i] = {static_cast<float>(i), static_cast<float>(i % 77)};
  for (std::size_t i = 0; i < wedge_.bins.iq.size(); ++i)
    wedge_.bins.video8.push_back(static_cast<std::uint8_t>(i % 77));
}

rendering::FrameRenderer::Plan PreparedRenderer::plan(const SettingsPtr& settings,
                                                      const PoseSettings&) const {
  Plan plan;
  plan.frame = std::make_unique<PreparedFrame>(settings, wedge_);
  return plan;
}

}  // namespace obliq::bench
