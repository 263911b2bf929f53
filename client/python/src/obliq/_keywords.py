"""The keywords that Settings and Pose take, for type checkers. Written by generate.py: do not edit."""
from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, TypedDict


class SettingsFields(TypedDict, total=False):
    """Keywords that Settings takes."""

    frequency_ghz: float | None
    mode: Literal["map", "mti", "dbs", "sar", "pulses"] | None
    sector_deg: float | None
    r_min_m: float | None
    r_max_m: float | None
    power_w: float | None
    gain_db: float | None
    range_normalisation: bool | None
    speckle: Literal["ground", "geometric", "none", "independent", "auto"] | None
    speckle_seed: int | None
    frustum: Literal["symmetric", "oblique", "polar", "sweep"] | None
    plates: Literal["spread", "nearest"] | None
    pixel_columns: int | None
    pixel_rows: int | None
    planes_per_bin: int | None
    sub_columns: int | None
    azimuth_bins: int | None
    range_bins: int | None
    scan_mode: Literal["frame", "sector", "circular"] | None
    scan_rate_deg_s: float | None
    scan_dwell_bins: int | None
    scan_bars: Sequence[float] | None
    beam_pattern: Literal["off", "gaussian", "uniform", "cosine", "taylor", "file"] | None
    beam_width_deg: float | None
    beam_sidelobe_db: float | None
    beam_nbar: int | None
    beam_extent_deg: float | None
    beam_elevation: Literal["off", "gaussian", "cosecant", "file"] | None
    beam_elevation_width_deg: float | None
    beam_cosecant_to_deg: float | None
    beam_stabilised: bool | None
    pulse_kind: Literal["off", "rectangular", "compressed"] | None
    pulse_length_us: float | None
    pulse_bandwidth_mhz: float | None
    pulse_window: Literal["none", "hamming", "hann", "taylor"] | None
    pulse_sidelobe_db: float | None
    pulse_nbar: int | None
    pulse_extent_bins: int | None
    pulse_eclipse: bool | None
    prf_hz: float | None
    pulse_stagger: Sequence[float] | None
    doppler_pulses: int | None
    doppler_window: Literal["none", "hamming", "hann", "taylor", "blackman_harris"] | None
    canceller: int | None
    clutter_lock: bool | None
    resolution_m: float | None
    noise: bool | None
    noise_figure_db: float | None
    antenna_temperature_k: float | None
    loss_db: float | None
    noise_seed: int | None
    noise_frame: int | None
    receiver_gain_db: float | None
    stc_range_m: float | None
    stc_power: float | None
    stc_db: float | None
    adc_bits: int | None
    full_scale_dbm: float | None
    video_looks: int | None
    video_floor_auto: bool | None
    video_floor_db: float | None
    video_span_db: float | None
    ftc_us: float | None
    rain_mm_h: float | None
    rain_top_m: float | None
    gas: bool | None
    polarisation: Literal["horizontal", "vertical"] | None
    wind_m_s: float | None
    wind_from_deg: float | None
    sea_state: float | None
    sea_state_auto: bool | None
    sea_shape: float | None


class PoseFields(TypedDict, total=False):
    """Keywords that Pose takes."""

    latitude_deg: float | None
    longitude_deg: float | None
    height_m: float | None
    height_reference: Literal["datum", "ground", "ellipsoid"] | None
    geoid_undulation_m: float | None
    bearing_deg: float | None
    heading_deg: float | None
    roll_deg: float | None
    pitch_deg: float | None
    velocity_north_m_s: float | None
    velocity_east_m_s: float | None
    velocity_up_m_s: float | None
    time_rate: float | None
    sim_time_ns: int | None
    pose_id: int | None
    valid_s: float | None
    tilt_deg: float | None
    tilt_auto: bool | None
