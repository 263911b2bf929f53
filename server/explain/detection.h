#pragma once
namespace obliq {

// A threshold on the amplitude of one pulse in receiver noise (Richards, Fundamentals of Radar Signal
// Processing, 2014, sections 6.3 and 6.5; Swerling 1960).

/// Probability that a target of such a mean signal-to-noise ratio is found at a false alarm probability.
/// swerling: 0 to 4; of one pulse 2 is as 1, and 4 as 3.
double detection_probability(int swerling, double snr, double false_alarm);

/// The mean signal-to-noise ratio, in dB, at which the probability is reached.
double detectable_snr_db(int swerling, double probability, double false_alarm);

}  // namespace obliq
