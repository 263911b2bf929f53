// The parameters of the receiver, of the video, of the atmosphere and of the sea.
#include <array>

#include "server/control/sections/parameter_row.h"

namespace obliq {
namespace {

using enum ModbusWords;

const std::array kParameters{
    parameter<&RadarSettings::receiver, &ReceiverSettings::noise>(
        "receiver.noise", "", kAny, "noise", {280, u16}, "Add the receiver's noise, k T B, to the bins.",
        {.not_ideal = true}),
    parameter<&RadarSettings::receiver, &ReceiverSettings::noise_figure_db>(
        "receiver.noise_figure_db", "dB", closed(0, 40), "noise_figure_db", {281, i32, 1e3},
        "Noise figure of the receiver at 290 K."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::antenna_temperature_k>(
        "receiver.antenna_temperature_k", "K", closed(3, 1e5), "antenna_temperature_k", {},
        "Noise temperature of what the antenna sees."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::loss_db>(
        "receiver.loss_db", "dB", closed(0, 60), "loss_db", {290, i32, 1e3},
        "Losses of the echo, there and back; they leave the noise as it is."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::noise_seed>(
        "receiver.noise_seed", "", kAny, "noise_seed", {}, "Each seed gives other noise."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::noise_frame>(
        "receiver.noise_frame", "", kAny, "noise_frame", {},
        "Number of the frame that obliq render or a RenderOnce makes the noise of; a live radar counts."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::gain_db>(
        "receiver.gain_db", "dB", closed(-200, 200), "receiver_gain_db", {283, i32, 1e3},
        "Gain of the receiver, of echoes and noise.", {.knob = "gain"}),
    parameter<&RadarSettings::receiver, &ReceiverSettings::stc_range_m>(
        "receiver.stc_range_m", "m", closed(0, 500e3), "stc_range_m", {285, i32, 1e3},
        "Sensitivity time control lowers the gain up to this slant range; 0: none.",
        {.knob = "sea (STC)", .not_ideal = true}),
    parameter<&RadarSettings::receiver, &ReceiverSettings::stc_power>(
        "receiver.stc_power", "", closed(0, 12), "stc_power", {287, u16, 1e2},
        "Its law: gain as (range / stc_range_m) to this power; 4 keeps a target's level."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::stc_db>("receiver.stc_db", "dB", closed(0, 200),
                                                                   "stc_db", {288, i32, 1e3},
                                                                   "It lowers the gain by at most this."),
    parameter<&RadarSettings::receiver, &ReceiverSettings::adc_bits>(
        "receiver.adc_bits", "", closed(0, 16), "adc_bits", {},
        "Bits of the converter, of I and of Q, 2 or more; 0: none.", {.not_ideal = true}),
    parameter<&RadarSettings::receiver, &ReceiverSettings::full_scale_dbm>(
        "receiver.full_scale_dbm", "dBm", closed(-200, 100), "full_scale_dbm", {},
        "Power of a sine that just fills the converter."),
    parameter<&RadarSettings::video, &VideoSettings::looks>(
        "video.looks", "", closed(1, 1024), "video_looks", {292, u16},
        "Pulses that the video integrates: it scatters as the mean of so many, in grains as large as one "
        "look's; 1: |I&Q|^2 itself."),
    parameter<&RadarSettings::video, &VideoSettings::floor_auto>(
        "video.floor_auto", "", kAny, "video_floor_auto", {293, u16},
        "Begin the video's scale at the noise, or 20 dB below ground at r_max; a floor_db alone ends it."),
    parameter<&RadarSettings::video, &VideoSettings::floor_db>(
        "video.floor_db", "dB", closed(-400, 400), "video_floor_db", {294, i32, 1e3},
        "Power at which the video's scale begins; \"auto\" in a scene file is video.floor_auto."),
    parameter<&RadarSettings::video, &VideoSettings::span_db>("video.span_db", "dB", closed(1, 400),
                                                              "video_span_db", {296, u16, 1e2},
                                                              "From there to the video's highest level."),
    parameter<&RadarSettings::video, &VideoSettings::ftc_us>(
        "video.ftc_us", "us", closed(0, 1000), "ftc_us", {321, i32, 1e3},
        "Fast time constant: the video is what a bin has above its mean over this time of range, so that "
        "rain goes "
        "and edges stay; 0: none.",
        {.knob = "rain (FTC)"}),
    parameter<&RadarSettings::atmosphere, &AtmosphereSettings::rain_mm_h>(
        "atmosphere.rain_mm_h", "mm/h", closed(0, 200), "rain_mm_h", {297, i32, 1e3},
        "Rain everywhere up to rain_top_m: attenuation and an echo of its own.",
        {.knob = "rainfall", .not_ideal = true}),
    parameter<&RadarSettings::atmosphere, &AtmosphereSettings::rain_top_m>(
        "atmosphere.rain_top_m", "m", closed(-1000, 20000), "rain_top_m", {},
        "Height of the rain's top above the datum."),
    parameter<&RadarSettings::atmosphere, &AtmosphereSettings::gas>(
        "atmosphere.gas", "", kAny, "gas", {299, u16},
        "Attenuation by oxygen and water vapour of the standard atmosphere at sea level."),
    parameter<&RadarSettings::atmosphere, &AtmosphereSettings::polarisation>(
        "atmosphere.polarisation", "", kPolarisations, "polarisation", {},
        "Of the radar's wave, for the rain's attenuation and the sea. radar.polarisation is the same."),
    parameter<&RadarSettings::atmosphere, &AtmosphereSettings::wind_m_s>(
        "atmosphere.wind_m_s", "m/s", closed(0, 60), "wind_m_s", {347, i32, 1e3},
        "Wind that moves woods, shrubs, grass and fields: a moving target indicator lets a part of them "
        "through. It gives the sea its direction, its mean Doppler, and with sea.state_auto its state.",
        {.knob = "wind", .modes = "mti pulses"}),
    parameter<&RadarSettings::atmosphere, &AtmosphereSettings::wind_from_deg>(
        "atmosphere.wind_from_deg", "deg", closed(0, 360), "wind_from_deg", {353, i32, 1e3},
        "Where the wind comes from, clockwise from true north: the sea returns more against it."),
    parameter<&RadarSettings::sea, &SeaSettings::state>(
        "sea.state", "", closed(0, 6), "sea_state", {349, u16, 1e2},
        "Sea state of all water (materials of model \"sea\"), by the NRL model of mean sea clutter; 0: water "
        "returns what its material says. With a state it moves, in all modes but map. "
        "\"auto\" in a scene file is sea.state_auto.",
        {.knob = "sea state"}),
    parameter<&RadarSettings::sea, &SeaSettings::state_auto>(
        "sea.state_auto", "", kAny, "sea_state_auto", {350, u16},
        "The sea state that atmosphere.wind_m_s raises; a sea.state alone ends it."),
    parameter<&RadarSettings::sea, &SeaSettings::shape>(
        "sea.shape", "", closed(0, 20), "sea_shape", {351, i32, 1e3},
        "Shape of the sea's texture in a small cell (K distribution): 0.1 is spiky, 20 nearly even; 0: no "
        "texture. Of use with a sea state. In a wind the texture drifts with the sim time: then echoes of a "
        "radar that stands still are not kept from frame to frame."),
};

}  // namespace

std::span<const Parameter> receiver_parameters() { return kParameters; }

}  // namespace obliq
