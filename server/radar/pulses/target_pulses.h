#pragma once
// The echoes of targets in a train of pulses: each pulse finds a target at a range of its own,
//   voltage  A g(th - th(t_n)) p(r_m - r(t_n) - f tau c / 2B) exp(j (phi - 4 pi r(t_n) / lambda))
// with A of TargetEchoes and the point response p. A compressed pulse sees what approaches by its own motion
// at a Doppler f a little nearer (range-Doppler coupling of an up-chirp; Richards 2014, section 4.6.4): the
// ground's ranges are what the scale is right for.
#include "server/radar/pulse_train.h"
#include "server/radar/pulses/boresight.h"
#include "server/radar/pulses/pulse_times.h"
#include "server/radar/targets/target_echoes.h"

namespace obliq {

/// To the gates of a train, in the pulses of a trip. Targets of Swerling's cases 2 and 4 are drawn anew in
/// each pulse. targets: with their motion (TargetLook::moves), of the trip's plan.
void add_target_pulses(const FramePlan& plan, const TargetEchoes& targets, const PulseTimes& times,
                       const Boresight& boresight, const PulseTrip& trip, PulseTrain& train);

}  // namespace obliq
