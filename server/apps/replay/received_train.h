#pragma once
#include "client/frame_assembler.h"
#include "server/radar/pulse_train.h"

namespace obliq {

/// A train that came over the wire or from a file, as a receiver gives it out.
PulseTrain received_train(client::AssembledTrain train);

}  // namespace obliq
