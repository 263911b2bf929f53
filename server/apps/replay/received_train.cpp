#include "server/apps/replay/received_train.h"

#include <utility>

namespace obliq {

PulseTrain received_train(client::AssembledTrain train) {
  return {{train.first_azimuth, train.n_azimuth},
          train.n_pulses,
          train.n_range,
          std::move(train.period_ns),
          train.boresight_start_deg,
          train.boresight_rate_deg_s,
          std::move(train.iq)};
}

}  // namespace obliq
