// The parameters of the antenna's beam and of the pulse.
#include <array>

#include "server/control/sections/parameter_row.h"

namespace obliq {
namespace {

// The lists follow their enumerations.
constexpr std::array kBeamPatterns{Choice{"off", "OFF_BEAM"},         Choice{"gaussian", "GAUSSIAN_BEAM"},
                                   Choice{"uniform", "UNIFORM_BEAM"}, Choice{"cosine", "COSINE_BEAM"},
                                   Choice{"taylor", "TAYLOR_BEAM"},   Choice{"file", "FILE_BEAM"}};
constexpr std::array kElevationPatterns{
    Choice{"off", "OFF_ELEVATION"}, Choice{"gaussian", "GAUSSIAN_ELEVATION"},
    Choice{"cosecant", "COSECANT_ELEVATION"}, Choice{"file", "FILE_ELEVATION"}};
constexpr std::array kPulseKinds{Choice{"off", "OFF_PULSE"}, Choice{"rectangular", "RECTANGULAR_PULSE"},
                                 Choice{"compressed", "COMPRESSED_PULSE"}};
constexpr std::array kPulseWindows{Choice{"none", "NONE_WINDOW"}, Choice{"hamming", "HAMMING_WINDOW"},
                                   Choice{"hann", "HANN_WINDOW"}, Choice{"taylor", "TAYLOR_WINDOW"}};

constexpr std::array kDopplerWindows{
    Choice{"none", "NONE_DOPPLER_WINDOW"}, Choice{"hamming", "HAMMING_DOPPLER_WINDOW"},
    Choice{"hann", "HANN_DOPPLER_WINDOW"}, Choice{"taylor", "TAYLOR_DOPPLER_WINDOW"},
    Choice{"blackman_harris", "BLACKMAN_HARRIS_DOPPLER_WINDOW"}};

using enum ModbusWords;

/// Sidelobes nearer to the main lobe than 13 dB need no taper; 60 dB both ways is below any converter.
constexpr Limits kSidelobe_db = closed(13, 60);

const std::array kParameters{
    parameter<&RadarSettings::beam, &BeamSettings::pattern>(
        "beam.pattern", "", kBeamPatterns, "beam_pattern", {261, u16},
        "The antenna's pattern in azimuth; off: each azimuth bin sees its own ground alone.",
        {.not_ideal = true}),
    parameter<&RadarSettings::beam, &BeamSettings::width_deg>("beam.width_deg", "deg", closed(0.05, 90),
                                                              "beam_width_deg", {262, i32, 1e3},
                                                              "One-way half-power beamwidth in azimuth."),
    parameter<&RadarSettings::beam, &BeamSettings::sidelobe_db>(
        "beam.sidelobe_db", "dB", kSidelobe_db, "beam_sidelobe_db", {264, u16, 1e2},
        "How far a Taylor pattern's sidelobes lie below its peak, one way."),
    parameter<&RadarSettings::beam, &BeamSettings::nbar>(
        "beam.nbar", "", closed(2, 20), "beam_nbar", {265, u16},
        "Sidelobes of a Taylor pattern that are nearly equal."),
    parameter<&RadarSettings::beam, &BeamSettings::extent_deg>(
        "beam.extent_deg", "deg", closed(0, 180), "beam_extent_deg", {266, i32, 1e3},
        "Beyond it the azimuth pattern is 0; 0: where it stays 30 dB down, at most four widths."),
    parameter<&RadarSettings::beam, &BeamSettings::elevation>(
        "beam.elevation", "", kElevationPatterns, "beam_elevation", {268, u16},
        "The antenna's pattern in elevation about antenna.tilt_deg: a pencil (gaussian) or a fan "
        "(cosecant).",
        {.not_ideal = true}),
    parameter<&RadarSettings::beam, &BeamSettings::elevation_width_deg>(
        "beam.elevation_width_deg", "deg", closed(0.05, 90), "beam_elevation_width_deg", {269, i32, 1e3},
        "One-way half-power beamwidth in elevation."),
    parameter<&RadarSettings::beam, &BeamSettings::cosecant_to_deg>(
        "beam.cosecant_to_deg", "deg", closed(0.1, 90), "beam_cosecant_to_deg", {271, i32, 1e3},
        "Depression to which a cosecant-squared pattern reaches."),
    parameter<&RadarSettings::beam, &BeamSettings::stabilised>(
        "beam.stabilised", "", kAny, "beam_stabilised", {337, u16},
        "Hold the antenna level whatever the platform does; false: its scan angles are the platform's own, "
        "and its "
        "beam rolls and pitches with it."),
    parameter<&RadarSettings::pulse, &PulseSettings::kind>(
        "pulse.kind", "", kPulseKinds, "pulse_kind", {273, u16},
        "What a point becomes in range; off: it stays in its range bin.", {.not_ideal = true}),
    parameter<&RadarSettings::pulse, &PulseSettings::length_us>(
        "pulse.length_us", "us", closed(0.001, 10000), "pulse_length_us", {274, i32, 1e3},
        "Length of the pulse; a rectangular one resolves c/2 times it."),
    parameter<&RadarSettings::pulse, &PulseSettings::bandwidth_mhz>(
        "pulse.bandwidth_mhz", "MHz", closed(0, 5000), "pulse_bandwidth_mhz", {276, i32, 1e3},
        "Bandwidth of a compressed pulse; 0: the range bin is its resolution, c/2B."),
    parameter<&RadarSettings::pulse, &PulseSettings::window>(
        "pulse.window", "", kPulseWindows, "pulse_window", {278, u16},
        "Weighting of a compressed pulse over its band."),
    parameter<&RadarSettings::pulse, &PulseSettings::sidelobe_db>(
        "pulse.sidelobe_db", "dB", kSidelobe_db, "pulse_sidelobe_db", {},
        "How far a Taylor window's range sidelobes lie below the peak."),
    parameter<&RadarSettings::pulse, &PulseSettings::nbar>(
        "pulse.nbar", "", closed(2, 20), "pulse_nbar", {},
        "Range sidelobes of a Taylor window that are nearly equal."),
    parameter<&RadarSettings::pulse, &PulseSettings::extent_bins>(
        "pulse.extent_bins", "", closed(1, 256), "pulse_extent_bins", {},
        "Range bins on either side that a point reaches, at most: a rectangular pulse ends where its "
        "triangle does."),
    parameter<&RadarSettings::pulse, &PulseSettings::eclipse>(
        "pulse.eclipse", "", kAny, "pulse_eclipse", {279, u16},
        "Cut the echo of what is nearer than half a pulse: the antenna still transmits."),
    parameter<&RadarSettings::pulse, &PulseSettings::prf_hz>(
        "pulse.prf_hz", "Hz", closed(1, 1e6), "prf_hz", {339, i32, 1e2},
        "Pulses a second, of the modes mti, dbs and pulses, and of the noise of sar; a radial speed of "
        "wavelength x PRF / 2 is blind.",
        {.knob = "PRF", .modes = "mti dbs sar pulses"}),
    parameter<&RadarSettings::pulse, &PulseSettings::stagger>(
        "pulse.stagger", "", closed(0.5, 2), "pulse_stagger", {},
        "Of pulse trains: intervals between pulses over 1 / prf_hz, one after the other, round and round; "
        "empty: all alike."),
    parameter<&RadarSettings::doppler, &DopplerSettings::pulses>(
        "doppler.pulses", "", closed(2, 1024), "doppler_pulses", {341, u16},
        "Pulses that a map sharpened by Doppler (dbs) adds up, so that beams become as narrow as their time "
        "allows; of a train (pulses).",
        {.knob = "pulses", .modes = "dbs pulses"}),
    parameter<&RadarSettings::doppler, &DopplerSettings::window>(
        "doppler.window", "", kDopplerWindows, "doppler_window", {342, u16},
        "Weights of these pulses, and of a synthetic aperture: wider beams, lower sidelobes.",
        {.knob = "window", .modes = "dbs sar"}),
    parameter<&RadarSettings::doppler, &DopplerSettings::canceller>(
        "doppler.canceller", "", closed(1, 3), "canceller", {343, u16},
        "Delays of the moving target indicator (mti): more of them cancel more of the ground.",
        {.knob = "canceller", .modes = "mti"}),
    parameter<&RadarSettings::doppler, &DopplerSettings::clutter_lock>(
        "doppler.clutter_lock", "", kAny, "clutter_lock", {344, u16},
        "The moving target indicator's notch follows the ground in the beam's middle: for a radar that "
        "flies.",
        {.knob = "clutter lock", .modes = "mti"}),
    parameter<&RadarSettings::doppler, &DopplerSettings::resolution_m>(
        "doppler.resolution_m", "m", closed(0.5, 100), "resolution_m", {345, i32, 1e3},
        "Of an image of synthetic aperture (sar), across range; along range the pulse has it.",
        {.knob = "resolution", .modes = "sar"}),
};

}  // namespace

std::span<const Parameter> beam_parameters() { return kParameters; }

}  // namespace obliq
