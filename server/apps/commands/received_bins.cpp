#include "server/apps/commands/received_bins.h"

#include <utility>

namespace obliq {

BinBlock take_bins(client::AssembledFrame& frame) {
  BinBlock bins;
  bins.n_azimuth = frame.n_azimuth;
  bins.n_range = frame.n_range;
  bins.iq = std::move(frame.iq);
  bins.power_w = std::move(frame.power_w);
  bins.count = std::move(frame.count);
  bins.state = std::move(frame.state);
  return bins;
}

}  // namespace obliq
