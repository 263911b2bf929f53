"""The parameters of a radar and the pose of its antenna. Written by generate.py: do not edit."""
from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

from ._fields import Fields
from ._keywords import PoseFields, SettingsFields

if TYPE_CHECKING:
    from typing_extensions import Unpack

__all__ = ["Pose", "PoseFields", "Settings", "SettingsFields"]


@dataclasses.dataclass(frozen=True, repr=False)
class Settings(Fields):
    """Settings of a radar. None: as it is, or the default where a frame is rendered.

    frequency_ghz: Carrier frequency. Allowed: number 0.03 to 300 GHz.
    mode: What the pulses make: the map of mean echoes, moving targets alone (mti), a map sharpened by Doppler (dbs), an
        image of synthetic aperture (sar), or nothing yet: the samples of pulse trains (pulses). Allowed: "map" | "mti" |
        "dbs" | "sar" | "pulses".
    sector_deg: Width of the sector in azimuth; the symmetric frustum needs less than 180. Allowed: number above 0, at most
        360 deg.
    r_min_m: Slant range of the near edge of the first range bin. Allowed: number 0 to 500000 m.
    r_max_m: Slant range of the far edge of the last range bin. Allowed: number above 0, at most 500000 m.
    power_w: Transmitted power; 0: a silent radar. Allowed: number 0 to 1000000000000 W.
    gain_db: One-way antenna gain at its peak; without [beam] the same in all directions. Allowed: number -100 to 100 dB.
    range_normalisation: Multiply amplitudes by range squared; phases stay. Allowed: true | false.
    speckle: Speckle fixed to the ground; the paper's, from the ranges of rays, so not with the sweep; none; or drawn anew
        for each azimuth bin. auto: independent where an antenna with a beam scans, else ground. Allowed: "ground" |
        "geometric" | "none" | "independent" | "auto".
    speckle_seed: Each seed gives another speckle pattern on the same ground. Allowed: any integer.
    frustum: How the ground is sampled: rays through the pixels of a camera, or vertical planes without rays. A scene file
        whose [frustum] is empty gets "sweep" (frustum.quality = "standard"). Allowed: "symmetric" | "oblique" | "sweep".
    plates: Spread a pixel's power over all range bins that it covers, or put it into the bin of its hit, as the paper does.
        Allowed: "spread" | "nearest".
    pixel_columns: Pixels across the sector; for the sweep, planes, rounded up to a whole number per azimuth bin, and at
        least one each half degree. frustum.pixels sets columns and rows. Allowed: integer 1 to 16384.
    pixel_rows: Pixels along range; the sweep has none. frustum.pixels = [columns, rows] sets both. Allowed: integer 1 to
        16384.
    planes_per_bin: Planes in each azimuth bin, of the sweep, where frustum.pixel_columns is not named beside it; 0: as
        frustum.quality says. Planes follow the bins, so that a narrower sector of fewer bins costs less. Allowed: integer 0
        to 1024.
    sub_columns: The most parts of an azimuth bin that see its buildings, of the sweep; where parts of 1.5 m are fewer,
        these do. A multiple of 16 or the next one; 0: exact planes at each building. Allowed: integer 0 to 1024.
    azimuth_bins: Azimuth bins in the sector. Allowed: integer 1 to 8192.
    range_bins: Range bins between r_min and r_max. Allowed: integer 1 to 8192.
    scan_mode: How a live radar scans: whole frames, back and forth across the sector, or round and round. Allowed: "frame"
        | "sector" | "circular".
    scan_rate_deg_s: Turning rate of the antenna; 36 is 6 turns per minute. A pass over the sector takes 10 ms to 60 s.
        Allowed: number 0.1 to 7200 deg/s.
    scan_dwell_bins: Azimuth bins rendered together from one pose; a multiple of 8. Allowed: integer 8 to 8192.
    scan_bars: Elevations of the boresight, one a pass of a scan, in turn; empty: antenna.tilt_deg. Allowed: a list of up to
        16 numbers, -90 to 90 deg.
    beam_pattern: The antenna's pattern in azimuth; off: each azimuth bin sees its own ground alone. Allowed: "off" |
        "gaussian" | "uniform" | "cosine" | "taylor" | "file".
    beam_width_deg: One-way half-power beamwidth in azimuth. Allowed: number 0.05 to 90 deg.
    beam_sidelobe_db: How far a Taylor pattern's sidelobes lie below its peak, one way. Allowed: number 13 to 60 dB.
    beam_nbar: Sidelobes of a Taylor pattern that are nearly equal. Allowed: integer 2 to 20.
    beam_extent_deg: Beyond it the azimuth pattern is 0; 0: where it stays 30 dB down, at most four widths. Allowed: number
        0 to 180 deg.
    beam_elevation: The antenna's pattern in elevation about antenna.tilt_deg: a pencil (gaussian) or a fan (cosecant).
        Allowed: "off" | "gaussian" | "cosecant" | "file".
    beam_elevation_width_deg: One-way half-power beamwidth in elevation. Allowed: number 0.05 to 90 deg.
    beam_cosecant_to_deg: Depression to which a cosecant-squared pattern reaches. Allowed: number 0.1 to 90 deg.
    beam_stabilised: Hold the antenna level whatever the platform does; false: its scan angles are the platform's own, and
        its beam rolls and pitches with it. Allowed: true | false.
    pulse_kind: What a point becomes in range; off: it stays in its range bin. Allowed: "off" | "rectangular" |
        "compressed".
    pulse_length_us: Length of the pulse; a rectangular one resolves c/2 times it. Allowed: number 0.001 to 10000 us.
    pulse_bandwidth_mhz: Bandwidth of a compressed pulse; 0: the range bin is its resolution, c/2B. Allowed: number 0 to
        5000 MHz.
    pulse_window: Weighting of a compressed pulse over its band. Allowed: "none" | "hamming" | "hann" | "taylor".
    pulse_sidelobe_db: How far a Taylor window's range sidelobes lie below the peak. Allowed: number 13 to 60 dB.
    pulse_nbar: Range sidelobes of a Taylor window that are nearly equal. Allowed: integer 2 to 20.
    pulse_extent_bins: Range bins on either side that a point reaches, at most: a rectangular pulse ends where its triangle
        does. Allowed: integer 1 to 256.
    pulse_eclipse: Cut the echo of what is nearer than half a pulse: the antenna still transmits. Allowed: true | false.
    prf_hz: Pulses a second, of the modes mti, dbs and pulses, and of the noise of sar; a radial speed of wavelength x PRF /
        2 is blind. Allowed: number 1 to 1000000 Hz.
    pulse_stagger: Of pulse trains: intervals between pulses over 1 / prf_hz, one after the other, round and round; empty:
        all alike. Allowed: a list of up to 16 numbers, 0.5 to 2.
    doppler_pulses: Pulses that a map sharpened by Doppler (dbs) adds up, so that beams become as narrow as their time
        allows; of a train (pulses). Allowed: integer 2 to 1024.
    doppler_window: Weights of these pulses, and of a synthetic aperture: wider beams, lower sidelobes. Allowed: "none" |
        "hamming" | "hann" | "taylor" | "blackman_harris".
    canceller: Delays of the moving target indicator (mti): more of them cancel more of the ground. Allowed: integer 1 to 3.
    clutter_lock: The moving target indicator's notch follows the ground in the beam's middle: for a radar that flies.
        Allowed: true | false.
    resolution_m: Of an image of synthetic aperture (sar), across range; along range the pulse has it. Allowed: number 0.5
        to 100 m.
    noise: Add the receiver's noise, k T B, to the bins. Allowed: true | false.
    noise_figure_db: Noise figure of the receiver at 290 K. Allowed: number 0 to 40 dB.
    antenna_temperature_k: Noise temperature of what the antenna sees. Allowed: number 3 to 100000 K.
    loss_db: Losses of the echo, there and back; they leave the noise as it is. Allowed: number 0 to 60 dB.
    noise_seed: Each seed gives other noise. Allowed: any integer.
    noise_frame: Number of the frame that obliq render or a RenderOnce makes the noise of; a live radar counts. Allowed:
        non-negative integer.
    receiver_gain_db: Gain of the receiver, of echoes and noise. Allowed: number -200 to 200 dB.
    stc_range_m: Sensitivity time control lowers the gain up to this slant range; 0: none. Allowed: number 0 to 500000 m.
    stc_power: Its law: gain as (range / stc_range_m) to this power; 4 keeps a target's level. Allowed: number 0 to 12.
    stc_db: It lowers the gain by at most this. Allowed: number 0 to 200 dB.
    adc_bits: Bits of the converter, of I and of Q, 2 or more; 0: none. Allowed: integer 0 to 16.
    full_scale_dbm: Power of a sine that just fills the converter. Allowed: number -200 to 100 dBm.
    video_looks: Pulses that the video integrates: it scatters as the mean of so many, in grains as large as one look's; 1:
        |I&Q|^2 itself. Allowed: integer 1 to 1024.
    video_floor_auto: Begin the video's scale at the noise, or 20 dB below ground at r_max; a floor_db alone ends it.
        Allowed: true | false.
    video_floor_db: Power at which the video's scale begins; "auto" in a scene file is video.floor_auto. Allowed: number
        -400 to 400 dB.
    video_span_db: From there to the video's highest level. Allowed: number 1 to 400 dB.
    ftc_us: Fast time constant: the video is what a bin has above its mean over this time of range, so that rain goes and
        edges stay; 0: none. Allowed: number 0 to 1000 us.
    rain_mm_h: Rain everywhere up to rain_top_m: attenuation and an echo of its own. Allowed: number 0 to 200 mm/h.
    rain_top_m: Height of the rain's top above the datum. Allowed: number -1000 to 20000 m.
    gas: Attenuation by oxygen and water vapour of the standard atmosphere at sea level. Allowed: true | false.
    polarisation: Of the radar's wave, for the rain's attenuation and the sea. radar.polarisation is the same. Allowed:
        "horizontal" | "vertical".
    wind_m_s: Wind that moves woods, shrubs, grass and fields: a moving target indicator lets a part of them through. It
        gives the sea its direction, its mean Doppler, and with sea.state_auto its state. Allowed: number 0 to 60 m/s.
    wind_from_deg: Where the wind comes from, clockwise from true north: the sea returns more against it. Allowed: number 0
        to 360 deg.
    sea_state: Sea state of all water (materials of model "sea"), by the NRL model of mean sea clutter; 0: water returns
        what its material says. With a state it moves, in all modes but map. "auto" in a scene file is sea.state_auto.
        Allowed: number 0 to 6.
    sea_state_auto: The sea state that atmosphere.wind_m_s raises; a sea.state alone ends it. Allowed: true | false.
    sea_shape: Shape of the sea's texture in a small cell (K distribution): 0.1 is spiky, 20 nearly even; 0: no texture. Of
        use with a sea state. In a wind the texture drifts with the sim time: then echoes of a radar that stands still are
        not kept from frame to frame. Allowed: number 0 to 20.
    """

    frequency_ghz: float | None = None
    mode: Literal["map", "mti", "dbs", "sar", "pulses"] | None = None
    sector_deg: float | None = None
    r_min_m: float | None = None
    r_max_m: float | None = None
    power_w: float | None = None
    gain_db: float | None = None
    range_normalisation: bool | None = None
    speckle: Literal["ground", "geometric", "none", "independent", "auto"] | None = None
    speckle_seed: int | None = None
    frustum: Literal["symmetric", "oblique", "polar", "sweep"] | None = None
    plates: Literal["spread", "nearest"] | None = None
    pixel_columns: int | None = None
    pixel_rows: int | None = None
    planes_per_bin: int | None = None
    sub_columns: int | None = None
    azimuth_bins: int | None = None
    range_bins: int | None = None
    scan_mode: Literal["frame", "sector", "circular"] | None = None
    scan_rate_deg_s: float | None = None
    scan_dwell_bins: int | None = None
    scan_bars: Sequence[float] | None = None
    beam_pattern: Literal["off", "gaussian", "uniform", "cosine", "taylor", "file"] | None = None
    beam_width_deg: float | None = None
    beam_sidelobe_db: float | None = None
    beam_nbar: int | None = None
    beam_extent_deg: float | None = None
    beam_elevation: Literal["off", "gaussian", "cosecant", "file"] | None = None
    beam_elevation_width_deg: float | None = None
    beam_cosecant_to_deg: float | None = None
    beam_stabilised: bool | None = None
    pulse_kind: Literal["off", "rectangular", "compressed"] | None = None
    pulse_length_us: float | None = None
    pulse_bandwidth_mhz: float | None = None
    pulse_window: Literal["none", "hamming", "hann", "taylor"] | None = None
    pulse_sidelobe_db: float | None = None
    pulse_nbar: int | None = None
    pulse_extent_bins: int | None = None
    pulse_eclipse: bool | None = None
    prf_hz: float | None = None
    pulse_stagger: Sequence[float] | None = None
    doppler_pulses: int | None = None
    doppler_window: Literal["none", "hamming", "hann", "taylor", "blackman_harris"] | None = None
    canceller: int | None = None
    clutter_lock: bool | None = None
    resolution_m: float | None = None
    noise: bool | None = None
    noise_figure_db: float | None = None
    antenna_temperature_k: float | None = None
    loss_db: float | None = None
    noise_seed: int | None = None
    noise_frame: int | None = None
    receiver_gain_db: float | None = None
    stc_range_m: float | None = None
    stc_power: float | None = None
    stc_db: float | None = None
    adc_bits: int | None = None
    full_scale_dbm: float | None = None
    video_looks: int | None = None
    video_floor_auto: bool | None = None
    video_floor_db: float | None = None
    video_span_db: float | None = None
    ftc_us: float | None = None
    rain_mm_h: float | None = None
    rain_top_m: float | None = None
    gas: bool | None = None
    polarisation: Literal["horizontal", "vertical"] | None = None
    wind_m_s: float | None = None
    wind_from_deg: float | None = None
    sea_state: float | None = None
    sea_state_auto: bool | None = None
    sea_shape: float | None = None

    def replace(self, **changes: Unpack[SettingsFields]) -> Settings:
        """The same, but for these."""
        return self._replaced(changes)


Settings.choices = {
    "mode": {
        "map": 0,
        "mti": 1,
        "dbs": 2,
        "sar": 3,
        "pulses": 4
    },
    "speckle": {
        "ground": 0,
        "geometric": 1,
        "none": 2,
        "independent": 3,
        "auto": 4
    },
    "frustum": {
        "symmetric": 1,
        "oblique": 0,
        "polar": 2,
        "sweep": 3
    },
    "plates": {
        "spread": 0,
        "nearest": 1
    },
    "scan_mode": {
        "frame": 0,
        "sector": 1,
        "circular": 2
    },
    "beam_pattern": {
        "off": 0,
        "gaussian": 1,
        "uniform": 2,
        "cosine": 3,
        "taylor": 4,
        "file": 5
    },
    "beam_elevation": {
        "off": 0,
        "gaussian": 1,
        "cosecant": 2,
        "file": 3
    },
    "pulse_kind": {
        "off": 0,
        "rectangular": 1,
        "compressed": 2
    },
    "pulse_window": {
        "none": 0,
        "hamming": 1,
        "hann": 2,
        "taylor": 3
    },
    "doppler_window": {
        "none": 0,
        "hamming": 1,
        "hann": 2,
        "taylor": 3,
        "blackman_harris": 4
    },
    "polarisation": {
        "horizontal": 0,
        "vertical": 1
    }
}
Settings.ideal = {
    "mode": "map",
    "beam_pattern": "off",
    "beam_elevation": "off",
    "pulse_kind": "off",
    "noise": False,
    "stc_range_m": 0.0,
    "adc_bits": 0,
    "rain_mm_h": 0.0
}
Settings.keys = {
    "radar.frequency_ghz": "frequency_ghz",
    "radar.mode": "mode",
    "radar.sector_deg": "sector_deg",
    "radar.r_min_m": "r_min_m",
    "radar.r_max_m": "r_max_m",
    "radar.power_w": "power_w",
    "radar.gain_db": "gain_db",
    "radar.range_normalisation": "range_normalisation",
    "radar.speckle": "speckle",
    "radar.speckle_seed": "speckle_seed",
    "frustum.kind": "frustum",
    "frustum.plates": "plates",
    "frustum.pixel_columns": "pixel_columns",
    "frustum.pixel_rows": "pixel_rows",
    "frustum.planes_per_bin": "planes_per_bin",
    "frustum.sub_columns": "sub_columns",
    "bins.azimuth": "azimuth_bins",
    "bins.range": "range_bins",
    "scan.mode": "scan_mode",
    "scan.rate_deg_s": "scan_rate_deg_s",
    "scan.dwell_bins": "scan_dwell_bins",
    "scan.bars": "scan_bars",
    "beam.pattern": "beam_pattern",
    "beam.width_deg": "beam_width_deg",
    "beam.sidelobe_db": "beam_sidelobe_db",
    "beam.nbar": "beam_nbar",
    "beam.extent_deg": "beam_extent_deg",
    "beam.elevation": "beam_elevation",
    "beam.elevation_width_deg": "beam_elevation_width_deg",
    "beam.cosecant_to_deg": "beam_cosecant_to_deg",
    "beam.stabilised": "beam_stabilised",
    "pulse.kind": "pulse_kind",
    "pulse.length_us": "pulse_length_us",
    "pulse.bandwidth_mhz": "pulse_bandwidth_mhz",
    "pulse.window": "pulse_window",
    "pulse.sidelobe_db": "pulse_sidelobe_db",
    "pulse.nbar": "pulse_nbar",
    "pulse.extent_bins": "pulse_extent_bins",
    "pulse.eclipse": "pulse_eclipse",
    "pulse.prf_hz": "prf_hz",
    "pulse.stagger": "pulse_stagger",
    "doppler.pulses": "doppler_pulses",
    "doppler.window": "doppler_window",
    "doppler.canceller": "canceller",
    "doppler.clutter_lock": "clutter_lock",
    "doppler.resolution_m": "resolution_m",
    "receiver.noise": "noise",
    "receiver.noise_figure_db": "noise_figure_db",
    "receiver.antenna_temperature_k": "antenna_temperature_k",
    "receiver.loss_db": "loss_db",
    "receiver.noise_seed": "noise_seed",
    "receiver.noise_frame": "noise_frame",
    "receiver.gain_db": "receiver_gain_db",
    "receiver.stc_range_m": "stc_range_m",
    "receiver.stc_power": "stc_power",
    "receiver.stc_db": "stc_db",
    "receiver.adc_bits": "adc_bits",
    "receiver.full_scale_dbm": "full_scale_dbm",
    "video.looks": "video_looks",
    "video.floor_auto": "video_floor_auto",
    "video.floor_db": "video_floor_db",
    "video.span_db": "video_span_db",
    "video.ftc_us": "ftc_us",
    "atmosphere.rain_mm_h": "rain_mm_h",
    "atmosphere.rain_top_m": "rain_top_m",
    "atmosphere.gas": "gas",
    "atmosphere.polarisation": "polarisation",
    "atmosphere.wind_m_s": "wind_m_s",
    "atmosphere.wind_from_deg": "wind_from_deg",
    "sea.state": "sea_state",
    "sea.state_auto": "sea_state_auto",
    "sea.shape": "sea_shape"
}


@dataclasses.dataclass(frozen=True, repr=False)
class Pose(Fields):
    """Where the antenna is and where it looks. None: as it is.

    latitude_deg: Geodetic latitude of the antenna; a scene file that names none gets the terrain's centre. Allowed: number
        -90 to 90 deg.
    longitude_deg: Longitude of the antenna, east positive; a scene file that names none gets the terrain's centre. Allowed:
        number -180 to 180 deg.
    height_m: Height of the antenna above antenna.height_reference. Allowed: number -1000 to 100000 m.
    height_reference: Zero of antenna.height_m: the terrain's datum, the ground below, or the WGS84 ellipsoid. Allowed:
        "datum" | "ground" | "ellipsoid".
    geoid_undulation_m: Height of the datum above the ellipsoid at the antenna; used with "ellipsoid" only. Allowed: number
        -120 to 120 m.
    bearing_deg: Centre of the sector, clockwise from true north at the antenna. Allowed: number -360 to 360 deg.
    heading_deg: Heading of the platform that carries the antenna, true; a scene file that names none gets the bearing.
        Allowed: number -360 to 360 deg.
    roll_deg: Roll of the platform, right side down positive; an antenna with beam.stabilised = false rolls with it.
        Allowed: number -60 to 60 deg.
    pitch_deg: Pitch of the platform, nose up positive; an antenna with beam.stabilised = false pitches with it. Allowed:
        number -60 to 60 deg.
    velocity_north_m_s: Velocity of the antenna over the ground, its part towards true north; auto: from the poses and their
        own times, where there are two. Of the three parts one that is not named beside another is 0. Allowed: "auto" or a
        number -20000 to 20000 m/s.
    velocity_east_m_s: The same towards east. Allowed: "auto" or a number -20000 to 20000 m/s.
    velocity_up_m_s: The same upwards; from the poses of heights above ground: the change of those heights. Allowed: "auto"
        or a number -20000 to 20000 m/s.
    time_rate: Seconds of the controller's clock in a second: 10 where an exercise runs ten times as fast. Allowed: number
        0.001 to 1000.
    sim_time_ns: Time of the pose by the controller's clock; the server interpolates between poses that have one. Allowed:
        integer -4e+18 to 4e+18 ns.
    pose_id: The controller's number for the pose; echoed, not used. Allowed: non-negative integer.
    valid_s: A pose is marked stale this long after it arrived if no other has arrived since; 0: never. Allowed: number 0 to
        86400 s.
    tilt_deg: Elevation of the boresight, up positive; of patterns in elevation. "auto" in a scene file is
        antenna.tilt_auto. Allowed: number -90 to 90 deg.
    tilt_auto: Tilt towards level ground in the middle of the swath instead of by antenna.tilt_deg. Allowed: true | false.
    """

    latitude_deg: float | None = None
    longitude_deg: float | None = None
    height_m: float | None = None
    height_reference: Literal["datum", "ground", "ellipsoid"] | None = None
    geoid_undulation_m: float | None = None
    bearing_deg: float | None = None
    heading_deg: float | None = None
    roll_deg: float | None = None
    pitch_deg: float | None = None
    velocity_north_m_s: float | None = None
    velocity_east_m_s: float | None = None
    velocity_up_m_s: float | None = None
    time_rate: float | None = None
    sim_time_ns: int | None = None
    pose_id: int | None = None
    valid_s: float | None = None
    tilt_deg: float | None = None
    tilt_auto: bool | None = None

    def replace(self, **changes: Unpack[PoseFields]) -> Pose:
        """The same, but for these."""
        return self._replaced(changes)


Pose.choices = {
    "height_reference": {
        "datum": 0,
        "ground": 1,
        "ellipsoid": 2
    }
}
Pose.keys = {
    "antenna.latitude_deg": "latitude_deg",
    "antenna.longitude_deg": "longitude_deg",
    "antenna.height_m": "height_m",
    "antenna.height_reference": "height_reference",
    "antenna.geoid_undulation_m": "geoid_undulation_m",
    "antenna.bearing_deg": "bearing_deg",
    "antenna.heading_deg": "heading_deg",
    "antenna.roll_deg": "roll_deg",
    "antenna.pitch_deg": "pitch_deg",
    "antenna.velocity_north_m_s": "velocity_north_m_s",
    "antenna.velocity_east_m_s": "velocity_east_m_s",
    "antenna.velocity_up_m_s": "velocity_up_m_s",
    "antenna.time_rate": "time_rate",
    "antenna.sim_time_ns": "sim_time_ns",
    "antenna.pose_id": "pose_id",
    "antenna.valid_s": "valid_s",
    "antenna.tilt_deg": "tilt_deg",
    "antenna.tilt_auto": "tilt_auto"
}
