from google.protobuf.internal import containers as _containers
from google.protobuf.internal import enum_type_wrapper as _enum_type_wrapper
from google.protobuf import descriptor as _descriptor
from google.protobuf import message as _message
from typing import ClassVar as _ClassVar, Iterable as _Iterable, Mapping as _Mapping, Optional as _Optional, Union as _Union

AIM_EVENT: EventKind
AUTO_SPECKLE: SpeckleKind
BLACKMAN_HARRIS_DOPPLER_WINDOW: DopplerWindow
BOOKMARK_EVENT: EventKind
BUILDING: PlaneKind
CF32_LE: IqEncodingKind
CI16_LE: IqEncodingKind
CIRCULAR_SCAN: ScanMode
CLAIM_EVENT: EventKind
COMPRESSED_PULSE: PulseKind
COSECANT_ELEVATION: ElevationPattern
COSINE_BEAM: BeamPattern
COUNT: PlaneKind
DATUM: HeightReference
DBS_MODE: RadarMode
DESCRIPTOR: _descriptor.FileDescriptor
ELLIPSOID: HeightReference
FILE_BEAM: BeamPattern
FILE_ELEVATION: ElevationPattern
FRAME_SCAN: ScanMode
FREEZE_EVENT: EventKind
GAUSSIAN_BEAM: BeamPattern
GAUSSIAN_ELEVATION: ElevationPattern
GEOMETRIC_SPECKLE: SpeckleKind
GROUND: HeightReference
GROUND_SPECKLE: SpeckleKind
HAMMING_DOPPLER_WINDOW: DopplerWindow
HAMMING_WINDOW: PulseWindow
HANN_DOPPLER_WINDOW: DopplerWindow
HANN_WINDOW: PulseWindow
HEIGHT: PlaneKind
HORIZONTAL: Polarisation
INDEPENDENT_SPECKLE: SpeckleKind
IQ: PlaneKind
LOAD_EVENT: EventKind
MAP_MODE: RadarMode
MATERIAL: PlaneKind
MTI_MODE: RadarMode
NEAREST_PLATES: PlateKind
NONE_DOPPLER_WINDOW: DopplerWindow
NONE_SPECKLE: SpeckleKind
NONE_WINDOW: PulseWindow
NO_EVENT: EventKind
OBLIQUE: FrustumKind
OFF_BEAM: BeamPattern
OFF_ELEVATION: ElevationPattern
OFF_PULSE: PulseKind
POLAR: FrustumKind
POSE_CLAIM: ClaimKind
POWER: PlaneKind
PULSES: PlaneKind
PULSES_MODE: RadarMode
RECTANGULAR_PULSE: PulseKind
RELEASE_EVENT: EventKind
RESET_EVENT: EventKind
RETURNS: PlaneKind
SAR_MODE: RadarMode
SECTOR_SCAN: ScanMode
SETTINGS_CLAIM: ClaimKind
SETTINGS_EVENT: EventKind
SPREAD_PLATES: PlateKind
STATE: PlaneKind
SWEEP: FrustumKind
SWITCH_EVENT: EventKind
SYMMETRIC: FrustumKind
TAKE_OVER_EVENT: EventKind
TARGET: PlaneKind
TARGETS_CLAIM: ClaimKind
TARGETS_EVENT: EventKind
TAYLOR_BEAM: BeamPattern
TAYLOR_DOPPLER_WINDOW: DopplerWindow
TAYLOR_WINDOW: PulseWindow
UNCOMPRESSED: CompressionKind
UNIFORM_BEAM: BeamPattern
VERTICAL: Polarisation
VIDEO: PlaneKind
ZSTD: CompressionKind

class Ack(_message.Message):
    __slots__ = ["coverage", "request_id", "settings_version", "warnings"]
    COVERAGE_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_VERSION_FIELD_NUMBER: _ClassVar[int]
    WARNINGS_FIELD_NUMBER: _ClassVar[int]
    coverage: float
    request_id: int
    settings_version: int
    warnings: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, request_id: _Optional[int] = ..., settings_version: _Optional[int] = ..., warnings: _Optional[_Iterable[str]] = ..., coverage: _Optional[float] = ...) -> None: ...

class AddBookmark(_message.Message):
    __slots__ = ["request_id", "text"]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    request_id: int
    text: str
    def __init__(self, request_id: _Optional[int] = ..., text: _Optional[str] = ...) -> None: ...

class AzimuthSpan(_message.Message):
    __slots__ = ["first_azimuth", "n_azimuth"]
    FIRST_AZIMUTH_FIELD_NUMBER: _ClassVar[int]
    N_AZIMUTH_FIELD_NUMBER: _ClassVar[int]
    first_azimuth: int
    n_azimuth: int
    def __init__(self, first_azimuth: _Optional[int] = ..., n_azimuth: _Optional[int] = ...) -> None: ...

class BinWindow(_message.Message):
    __slots__ = ["azimuth_step", "first_azimuth", "first_range", "n_azimuth", "n_range", "range_step"]
    AZIMUTH_STEP_FIELD_NUMBER: _ClassVar[int]
    FIRST_AZIMUTH_FIELD_NUMBER: _ClassVar[int]
    FIRST_RANGE_FIELD_NUMBER: _ClassVar[int]
    N_AZIMUTH_FIELD_NUMBER: _ClassVar[int]
    N_RANGE_FIELD_NUMBER: _ClassVar[int]
    RANGE_STEP_FIELD_NUMBER: _ClassVar[int]
    azimuth_step: int
    first_azimuth: int
    first_range: int
    n_azimuth: int
    n_range: int
    range_step: int
    def __init__(self, first_azimuth: _Optional[int] = ..., n_azimuth: _Optional[int] = ..., azimuth_step: _Optional[int] = ..., first_range: _Optional[int] = ..., n_range: _Optional[int] = ..., range_step: _Optional[int] = ...) -> None: ...

class BuildingHeights(_message.Message):
    __slots__ = ["by_default", "default_m", "field", "file", "found", "least_m", "median_m", "most_m", "unit"]
    BY_DEFAULT_FIELD_NUMBER: _ClassVar[int]
    DEFAULT_M_FIELD_NUMBER: _ClassVar[int]
    FIELD_FIELD_NUMBER: _ClassVar[int]
    FILE_FIELD_NUMBER: _ClassVar[int]
    FOUND_FIELD_NUMBER: _ClassVar[int]
    LEAST_M_FIELD_NUMBER: _ClassVar[int]
    MEDIAN_M_FIELD_NUMBER: _ClassVar[int]
    MOST_M_FIELD_NUMBER: _ClassVar[int]
    UNIT_FIELD_NUMBER: _ClassVar[int]
    by_default: int
    default_m: float
    field: str
    file: str
    found: int
    least_m: float
    median_m: float
    most_m: float
    unit: str
    def __init__(self, file: _Optional[str] = ..., field: _Optional[str] = ..., unit: _Optional[str] = ..., found: _Optional[int] = ..., least_m: _Optional[float] = ..., median_m: _Optional[float] = ..., most_m: _Optional[float] = ..., by_default: _Optional[int] = ..., default_m: _Optional[float] = ...) -> None: ...

class ClaimControl(_message.Message):
    __slots__ = ["force", "kinds", "radar", "request_id"]
    FORCE_FIELD_NUMBER: _ClassVar[int]
    KINDS_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    force: bool
    kinds: _containers.RepeatedScalarFieldContainer[ClaimKind]
    radar: str
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., force: bool = ..., kinds: _Optional[_Iterable[_Union[ClaimKind, str]]] = ...) -> None: ...

class ElevationModel(_message.Message):
    __slots__ = ["file", "unit", "unit_assumed"]
    FILE_FIELD_NUMBER: _ClassVar[int]
    UNIT_ASSUMED_FIELD_NUMBER: _ClassVar[int]
    UNIT_FIELD_NUMBER: _ClassVar[int]
    file: str
    unit: str
    unit_assumed: bool
    def __init__(self, file: _Optional[str] = ..., unit: _Optional[str] = ..., unit_assumed: bool = ...) -> None: ...

class Error(_message.Message):
    __slots__ = ["fields", "number", "radar", "request_id", "text"]
    FIELDS_FIELD_NUMBER: _ClassVar[int]
    NUMBER_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    fields: _containers.RepeatedCompositeFieldContainer[FieldFault]
    number: int
    radar: str
    request_id: int
    text: str
    def __init__(self, request_id: _Optional[int] = ..., number: _Optional[int] = ..., text: _Optional[str] = ..., fields: _Optional[_Iterable[_Union[FieldFault, _Mapping]]] = ..., radar: _Optional[str] = ...) -> None: ...

class ExerciseEvent(_message.Message):
    __slots__ = ["by", "claims", "freeze", "kind", "number", "pose", "radar", "rate_limit_hz", "settings", "sim_time_ns", "state", "taken_from", "targets_come", "targets_gone", "text", "transmit", "utc_ns"]
    BY_FIELD_NUMBER: _ClassVar[int]
    CLAIMS_FIELD_NUMBER: _ClassVar[int]
    FREEZE_FIELD_NUMBER: _ClassVar[int]
    KIND_FIELD_NUMBER: _ClassVar[int]
    NUMBER_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RATE_LIMIT_HZ_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_FIELD_NUMBER: _ClassVar[int]
    SIM_TIME_NS_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    TAKEN_FROM_FIELD_NUMBER: _ClassVar[int]
    TARGETS_COME_FIELD_NUMBER: _ClassVar[int]
    TARGETS_GONE_FIELD_NUMBER: _ClassVar[int]
    TEXT_FIELD_NUMBER: _ClassVar[int]
    TRANSMIT_FIELD_NUMBER: _ClassVar[int]
    UTC_NS_FIELD_NUMBER: _ClassVar[int]
    by: str
    claims: _containers.RepeatedScalarFieldContainer[ClaimKind]
    freeze: bool
    kind: EventKind
    number: int
    pose: Pose
    radar: str
    rate_limit_hz: float
    settings: RadarSettings
    sim_time_ns: int
    state: ExerciseState
    taken_from: str
    targets_come: int
    targets_gone: int
    text: str
    transmit: bool
    utc_ns: int
    def __init__(self, number: _Optional[int] = ..., utc_ns: _Optional[int] = ..., kind: _Optional[_Union[EventKind, str]] = ..., by: _Optional[str] = ..., radar: _Optional[str] = ..., sim_time_ns: _Optional[int] = ..., claims: _Optional[_Iterable[_Union[ClaimKind, str]]] = ..., taken_from: _Optional[str] = ..., settings: _Optional[_Union[RadarSettings, _Mapping]] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., transmit: bool = ..., freeze: bool = ..., rate_limit_hz: _Optional[float] = ..., state: _Optional[_Union[ExerciseState, _Mapping]] = ..., text: _Optional[str] = ..., targets_come: _Optional[int] = ..., targets_gone: _Optional[int] = ...) -> None: ...

class ExerciseEvents(_message.Message):
    __slots__ = ["events", "frozen", "lost", "more", "request_id", "state"]
    EVENTS_FIELD_NUMBER: _ClassVar[int]
    FROZEN_FIELD_NUMBER: _ClassVar[int]
    LOST_FIELD_NUMBER: _ClassVar[int]
    MORE_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    events: _containers.RepeatedCompositeFieldContainer[ExerciseEvent]
    frozen: bool
    lost: int
    more: bool
    request_id: int
    state: ExerciseState
    def __init__(self, request_id: _Optional[int] = ..., events: _Optional[_Iterable[_Union[ExerciseEvent, _Mapping]]] = ..., more: bool = ..., lost: _Optional[int] = ..., state: _Optional[_Union[ExerciseState, _Mapping]] = ..., frozen: bool = ...) -> None: ...

class ExerciseState(_message.Message):
    __slots__ = ["build", "platforms", "radars", "request_id", "scene_hash", "scene_name", "targets", "version", "with_targets"]
    BUILD_FIELD_NUMBER: _ClassVar[int]
    PLATFORMS_FIELD_NUMBER: _ClassVar[int]
    RADARS_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SCENE_HASH_FIELD_NUMBER: _ClassVar[int]
    SCENE_NAME_FIELD_NUMBER: _ClassVar[int]
    TARGETS_FIELD_NUMBER: _ClassVar[int]
    VERSION_FIELD_NUMBER: _ClassVar[int]
    WITH_TARGETS_FIELD_NUMBER: _ClassVar[int]
    build: str
    platforms: _containers.RepeatedCompositeFieldContainer[PlatformState]
    radars: _containers.RepeatedCompositeFieldContainer[RadarState]
    request_id: int
    scene_hash: str
    scene_name: str
    targets: _containers.RepeatedCompositeFieldContainer[Target]
    version: int
    with_targets: bool
    def __init__(self, request_id: _Optional[int] = ..., version: _Optional[int] = ..., scene_hash: _Optional[str] = ..., scene_name: _Optional[str] = ..., build: _Optional[str] = ..., radars: _Optional[_Iterable[_Union[RadarState, _Mapping]]] = ..., platforms: _Optional[_Iterable[_Union[PlatformState, _Mapping]]] = ..., targets: _Optional[_Iterable[_Union[Target, _Mapping]]] = ..., with_targets: bool = ...) -> None: ...

class FieldFault(_message.Message):
    __slots__ = ["allowed", "field", "found"]
    ALLOWED_FIELD_NUMBER: _ClassVar[int]
    FIELD_FIELD_NUMBER: _ClassVar[int]
    FOUND_FIELD_NUMBER: _ClassVar[int]
    allowed: str
    field: str
    found: str
    def __init__(self, field: _Optional[str] = ..., found: _Optional[str] = ..., allowed: _Optional[str] = ...) -> None: ...

class FrameAbort(_message.Message):
    __slots__ = ["frame_id", "reason", "request_id"]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    REASON_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    frame_id: int
    reason: str
    request_id: int
    def __init__(self, frame_id: _Optional[int] = ..., request_id: _Optional[int] = ..., reason: _Optional[str] = ...) -> None: ...

class FrameBegin(_message.Message):
    __slots__ = ["frame", "frame_id", "frames_skipped", "request_id", "scan", "wedges"]
    FRAMES_SKIPPED_FIELD_NUMBER: _ClassVar[int]
    FRAME_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SCAN_FIELD_NUMBER: _ClassVar[int]
    WEDGES_FIELD_NUMBER: _ClassVar[int]
    frame: FrameDescriptor
    frame_id: int
    frames_skipped: int
    request_id: int
    scan: ScanPass
    wedges: int
    def __init__(self, frame_id: _Optional[int] = ..., request_id: _Optional[int] = ..., frame: _Optional[_Union[FrameDescriptor, _Mapping]] = ..., wedges: _Optional[int] = ..., frames_skipped: _Optional[int] = ..., scan: _Optional[_Union[ScanPass, _Mapping]] = ...) -> None: ...

class FrameDescriptor(_message.Message):
    __slots__ = ["adc_step", "antenna_x_m", "antenna_y_m", "antenna_z_m", "azimuth_error_bound_rad", "azimuth_reference", "azimuth_start_deg", "azimuth_width_deg", "bottom_y_m", "build", "buildings_in_scene", "cell_m", "frame_id", "ground", "map_reference_height_m", "materials", "noise_counter", "noise_power_w", "north_rad", "origin_latitude_deg", "origin_longitude_deg", "phase_sign", "pose", "pose_stale", "power_unit", "radar", "radius_factor", "range_spacing_m", "range_start_m", "scene_hash", "scene_name", "settings", "settings_version", "source_error", "targets", "targets_version", "top_y_m", "unit", "video_floor_db", "warnings", "wavelength_m", "wedge_azimuth_bins", "window"]
    ADC_STEP_FIELD_NUMBER: _ClassVar[int]
    ANTENNA_X_M_FIELD_NUMBER: _ClassVar[int]
    ANTENNA_Y_M_FIELD_NUMBER: _ClassVar[int]
    ANTENNA_Z_M_FIELD_NUMBER: _ClassVar[int]
    AZIMUTH_ERROR_BOUND_RAD_FIELD_NUMBER: _ClassVar[int]
    AZIMUTH_REFERENCE_FIELD_NUMBER: _ClassVar[int]
    AZIMUTH_START_DEG_FIELD_NUMBER: _ClassVar[int]
    AZIMUTH_WIDTH_DEG_FIELD_NUMBER: _ClassVar[int]
    BOTTOM_Y_M_FIELD_NUMBER: _ClassVar[int]
    BUILDINGS_IN_SCENE_FIELD_NUMBER: _ClassVar[int]
    BUILD_FIELD_NUMBER: _ClassVar[int]
    CELL_M_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    GROUND_FIELD_NUMBER: _ClassVar[int]
    MAP_REFERENCE_HEIGHT_M_FIELD_NUMBER: _ClassVar[int]
    MATERIALS_FIELD_NUMBER: _ClassVar[int]
    NOISE_COUNTER_FIELD_NUMBER: _ClassVar[int]
    NOISE_POWER_W_FIELD_NUMBER: _ClassVar[int]
    NORTH_RAD_FIELD_NUMBER: _ClassVar[int]
    ORIGIN_LATITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    ORIGIN_LONGITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    PHASE_SIGN_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    POSE_STALE_FIELD_NUMBER: _ClassVar[int]
    POWER_UNIT_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RADIUS_FACTOR_FIELD_NUMBER: _ClassVar[int]
    RANGE_SPACING_M_FIELD_NUMBER: _ClassVar[int]
    RANGE_START_M_FIELD_NUMBER: _ClassVar[int]
    SCENE_HASH_FIELD_NUMBER: _ClassVar[int]
    SCENE_NAME_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_VERSION_FIELD_NUMBER: _ClassVar[int]
    SOURCE_ERROR_FIELD_NUMBER: _ClassVar[int]
    TARGETS_FIELD_NUMBER: _ClassVar[int]
    TARGETS_VERSION_FIELD_NUMBER: _ClassVar[int]
    TOP_Y_M_FIELD_NUMBER: _ClassVar[int]
    UNIT_FIELD_NUMBER: _ClassVar[int]
    VIDEO_FLOOR_DB_FIELD_NUMBER: _ClassVar[int]
    WARNINGS_FIELD_NUMBER: _ClassVar[int]
    WAVELENGTH_M_FIELD_NUMBER: _ClassVar[int]
    WEDGE_AZIMUTH_BINS_FIELD_NUMBER: _ClassVar[int]
    WINDOW_FIELD_NUMBER: _ClassVar[int]
    adc_step: float
    antenna_x_m: float
    antenna_y_m: float
    antenna_z_m: float
    azimuth_error_bound_rad: float
    azimuth_reference: str
    azimuth_start_deg: float
    azimuth_width_deg: float
    bottom_y_m: float
    build: str
    buildings_in_scene: int
    cell_m: float
    frame_id: int
    ground: LoadedGround
    map_reference_height_m: float
    materials: _containers.RepeatedCompositeFieldContainer[Material]
    noise_counter: int
    noise_power_w: float
    north_rad: float
    origin_latitude_deg: float
    origin_longitude_deg: float
    phase_sign: int
    pose: Pose
    pose_stale: bool
    power_unit: str
    radar: str
    radius_factor: float
    range_spacing_m: float
    range_start_m: float
    scene_hash: str
    scene_name: str
    settings: RadarSettings
    settings_version: int
    source_error: SourceError
    targets: int
    targets_version: int
    top_y_m: float
    unit: str
    video_floor_db: float
    warnings: _containers.RepeatedScalarFieldContainer[str]
    wavelength_m: float
    wedge_azimuth_bins: int
    window: BinWindow
    def __init__(self, radar: _Optional[str] = ..., frame_id: _Optional[int] = ..., settings_version: _Optional[int] = ..., settings: _Optional[_Union[RadarSettings, _Mapping]] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., origin_latitude_deg: _Optional[float] = ..., origin_longitude_deg: _Optional[float] = ..., radius_factor: _Optional[float] = ..., antenna_x_m: _Optional[float] = ..., antenna_y_m: _Optional[float] = ..., antenna_z_m: _Optional[float] = ..., north_rad: _Optional[float] = ..., wavelength_m: _Optional[float] = ..., azimuth_start_deg: _Optional[float] = ..., azimuth_width_deg: _Optional[float] = ..., range_start_m: _Optional[float] = ..., range_spacing_m: _Optional[float] = ..., phase_sign: _Optional[int] = ..., unit: _Optional[str] = ..., azimuth_reference: _Optional[str] = ..., bottom_y_m: _Optional[float] = ..., top_y_m: _Optional[float] = ..., map_reference_height_m: _Optional[float] = ..., azimuth_error_bound_rad: _Optional[float] = ..., materials: _Optional[_Iterable[_Union[Material, _Mapping]]] = ..., scene_name: _Optional[str] = ..., cell_m: _Optional[float] = ..., wedge_azimuth_bins: _Optional[int] = ..., warnings: _Optional[_Iterable[str]] = ..., buildings_in_scene: _Optional[int] = ..., power_unit: _Optional[str] = ..., source_error: _Optional[_Union[SourceError, _Mapping]] = ..., window: _Optional[_Union[BinWindow, _Mapping]] = ..., pose_stale: bool = ..., ground: _Optional[_Union[LoadedGround, _Mapping]] = ..., noise_power_w: _Optional[float] = ..., noise_counter: _Optional[int] = ..., adc_step: _Optional[float] = ..., video_floor_db: _Optional[float] = ..., scene_hash: _Optional[str] = ..., build: _Optional[str] = ..., targets_version: _Optional[int] = ..., targets: _Optional[int] = ...) -> None: ...

class FrameEnd(_message.Message):
    __slots__ = ["frame_id", "missed", "render_s", "summary", "waited_s"]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    MISSED_FIELD_NUMBER: _ClassVar[int]
    RENDER_S_FIELD_NUMBER: _ClassVar[int]
    SUMMARY_FIELD_NUMBER: _ClassVar[int]
    WAITED_S_FIELD_NUMBER: _ClassVar[int]
    frame_id: int
    missed: _containers.RepeatedCompositeFieldContainer[AzimuthSpan]
    render_s: float
    summary: FrameSummary
    waited_s: float
    def __init__(self, frame_id: _Optional[int] = ..., summary: _Optional[_Union[FrameSummary, _Mapping]] = ..., render_s: _Optional[float] = ..., waited_s: _Optional[float] = ..., missed: _Optional[_Iterable[_Union[AzimuthSpan, _Mapping]]] = ...) -> None: ...

class FrameSummary(_message.Message):
    __slots__ = ["buildings_seen", "coverage", "frame_id", "hits", "lit_bins", "rays", "rejected", "repaired", "samples", "unsampled_bins", "warnings"]
    BUILDINGS_SEEN_FIELD_NUMBER: _ClassVar[int]
    COVERAGE_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    HITS_FIELD_NUMBER: _ClassVar[int]
    LIT_BINS_FIELD_NUMBER: _ClassVar[int]
    RAYS_FIELD_NUMBER: _ClassVar[int]
    REJECTED_FIELD_NUMBER: _ClassVar[int]
    REPAIRED_FIELD_NUMBER: _ClassVar[int]
    SAMPLES_FIELD_NUMBER: _ClassVar[int]
    UNSAMPLED_BINS_FIELD_NUMBER: _ClassVar[int]
    WARNINGS_FIELD_NUMBER: _ClassVar[int]
    buildings_seen: int
    coverage: float
    frame_id: int
    hits: int
    lit_bins: int
    rays: int
    rejected: int
    repaired: int
    samples: int
    unsampled_bins: int
    warnings: _containers.RepeatedScalarFieldContainer[str]
    def __init__(self, frame_id: _Optional[int] = ..., rays: _Optional[int] = ..., hits: _Optional[int] = ..., samples: _Optional[int] = ..., rejected: _Optional[int] = ..., coverage: _Optional[float] = ..., buildings_seen: _Optional[int] = ..., repaired: _Optional[int] = ..., lit_bins: _Optional[int] = ..., unsampled_bins: _Optional[int] = ..., warnings: _Optional[_Iterable[str]] = ...) -> None: ...

class GetEvents(_message.Message):
    __slots__ = ["after", "follow", "request_id", "with_state"]
    AFTER_FIELD_NUMBER: _ClassVar[int]
    FOLLOW_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    WITH_STATE_FIELD_NUMBER: _ClassVar[int]
    after: int
    follow: bool
    request_id: int
    with_state: bool
    def __init__(self, request_id: _Optional[int] = ..., after: _Optional[int] = ..., follow: bool = ..., with_state: bool = ...) -> None: ...

class GetExercise(_message.Message):
    __slots__ = ["request_id", "without_targets"]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    WITHOUT_TARGETS_FIELD_NUMBER: _ClassVar[int]
    request_id: int
    without_targets: bool
    def __init__(self, request_id: _Optional[int] = ..., without_targets: bool = ...) -> None: ...

class GetRadar(_message.Message):
    __slots__ = ["radar", "request_id"]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    radar: str
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ...) -> None: ...

class GetStatus(_message.Message):
    __slots__ = ["request_id"]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    request_id: int
    def __init__(self, request_id: _Optional[int] = ...) -> None: ...

class GetTargets(_message.Message):
    __slots__ = ["after", "request_id"]
    AFTER_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    after: int
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., after: _Optional[int] = ...) -> None: ...

class GroundAnswer(_message.Message):
    __slots__ = ["antenna", "materials", "points", "record_bytes", "request_id"]
    ANTENNA_FIELD_NUMBER: _ClassVar[int]
    MATERIALS_FIELD_NUMBER: _ClassVar[int]
    POINTS_FIELD_NUMBER: _ClassVar[int]
    RECORD_BYTES_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    antenna: Pose
    materials: _containers.RepeatedScalarFieldContainer[str]
    points: int
    record_bytes: int
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., points: _Optional[int] = ..., record_bytes: _Optional[int] = ..., materials: _Optional[_Iterable[str]] = ..., antenna: _Optional[_Union[Pose, _Mapping]] = ...) -> None: ...

class Heartbeat(_message.Message):
    __slots__ = ["answer_wanted", "request_id"]
    ANSWER_WANTED_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    answer_wanted: bool
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., answer_wanted: bool = ...) -> None: ...

class Hello(_message.Message):
    __slots__ = ["client_name", "major", "minor", "request_id", "token"]
    CLIENT_NAME_FIELD_NUMBER: _ClassVar[int]
    MAJOR_FIELD_NUMBER: _ClassVar[int]
    MINOR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TOKEN_FIELD_NUMBER: _ClassVar[int]
    client_name: str
    major: int
    minor: int
    request_id: int
    token: str
    def __init__(self, request_id: _Optional[int] = ..., major: _Optional[int] = ..., minor: _Optional[int] = ..., client_name: _Optional[str] = ..., token: _Optional[str] = ...) -> None: ...

class Limits(_message.Message):
    __slots__ = ["heartbeat_s", "idle_timeout_s", "max_bins", "max_clients", "max_clients_per_address", "max_memory_mb", "max_pixels", "max_plane_bytes", "max_query_points", "max_rate_hz", "max_renders_queued", "max_request_bytes", "max_subscriptions", "max_targets", "max_work_queued"]
    HEARTBEAT_S_FIELD_NUMBER: _ClassVar[int]
    IDLE_TIMEOUT_S_FIELD_NUMBER: _ClassVar[int]
    MAX_BINS_FIELD_NUMBER: _ClassVar[int]
    MAX_CLIENTS_FIELD_NUMBER: _ClassVar[int]
    MAX_CLIENTS_PER_ADDRESS_FIELD_NUMBER: _ClassVar[int]
    MAX_MEMORY_MB_FIELD_NUMBER: _ClassVar[int]
    MAX_PIXELS_FIELD_NUMBER: _ClassVar[int]
    MAX_PLANE_BYTES_FIELD_NUMBER: _ClassVar[int]
    MAX_QUERY_POINTS_FIELD_NUMBER: _ClassVar[int]
    MAX_RATE_HZ_FIELD_NUMBER: _ClassVar[int]
    MAX_RENDERS_QUEUED_FIELD_NUMBER: _ClassVar[int]
    MAX_REQUEST_BYTES_FIELD_NUMBER: _ClassVar[int]
    MAX_SUBSCRIPTIONS_FIELD_NUMBER: _ClassVar[int]
    MAX_TARGETS_FIELD_NUMBER: _ClassVar[int]
    MAX_WORK_QUEUED_FIELD_NUMBER: _ClassVar[int]
    heartbeat_s: float
    idle_timeout_s: float
    max_bins: int
    max_clients: int
    max_clients_per_address: int
    max_memory_mb: int
    max_pixels: int
    max_plane_bytes: int
    max_query_points: int
    max_rate_hz: float
    max_renders_queued: int
    max_request_bytes: int
    max_subscriptions: int
    max_targets: int
    max_work_queued: int
    def __init__(self, max_request_bytes: _Optional[int] = ..., max_plane_bytes: _Optional[int] = ..., max_clients: _Optional[int] = ..., max_renders_queued: _Optional[int] = ..., max_subscriptions: _Optional[int] = ..., max_rate_hz: _Optional[float] = ..., max_clients_per_address: _Optional[int] = ..., max_pixels: _Optional[int] = ..., max_bins: _Optional[int] = ..., max_work_queued: _Optional[int] = ..., max_memory_mb: _Optional[int] = ..., heartbeat_s: _Optional[float] = ..., idle_timeout_s: _Optional[float] = ..., max_query_points: _Optional[int] = ..., max_targets: _Optional[int] = ...) -> None: ...

class ListRadars(_message.Message):
    __slots__ = ["request_id"]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    request_id: int
    def __init__(self, request_id: _Optional[int] = ...) -> None: ...

class LoadExercise(_message.Message):
    __slots__ = ["request_id", "state"]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    STATE_FIELD_NUMBER: _ClassVar[int]
    request_id: int
    state: ExerciseState
    def __init__(self, request_id: _Optional[int] = ..., state: _Optional[_Union[ExerciseState, _Mapping]] = ...) -> None: ...

class LoadedGround(_message.Message):
    __slots__ = ["building_heights", "elevation", "highest_m", "lowest_m", "water_km2"]
    BUILDING_HEIGHTS_FIELD_NUMBER: _ClassVar[int]
    ELEVATION_FIELD_NUMBER: _ClassVar[int]
    HIGHEST_M_FIELD_NUMBER: _ClassVar[int]
    LOWEST_M_FIELD_NUMBER: _ClassVar[int]
    WATER_KM2_FIELD_NUMBER: _ClassVar[int]
    building_heights: _containers.RepeatedCompositeFieldContainer[BuildingHeights]
    elevation: _containers.RepeatedCompositeFieldContainer[ElevationModel]
    highest_m: float
    lowest_m: float
    water_km2: float
    def __init__(self, elevation: _Optional[_Iterable[_Union[ElevationModel, _Mapping]]] = ..., lowest_m: _Optional[float] = ..., highest_m: _Optional[float] = ..., building_heights: _Optional[_Iterable[_Union[BuildingHeights, _Mapping]]] = ..., water_km2: _Optional[float] = ...) -> None: ...

class Material(_message.Message):
    __slots__ = ["gamma", "model", "name", "plate_exponent", "plate_tau", "reflectivity", "rms_slope"]
    GAMMA_FIELD_NUMBER: _ClassVar[int]
    MODEL_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    PLATE_EXPONENT_FIELD_NUMBER: _ClassVar[int]
    PLATE_TAU_FIELD_NUMBER: _ClassVar[int]
    REFLECTIVITY_FIELD_NUMBER: _ClassVar[int]
    RMS_SLOPE_FIELD_NUMBER: _ClassVar[int]
    gamma: float
    model: str
    name: str
    plate_exponent: float
    plate_tau: float
    reflectivity: float
    rms_slope: float
    def __init__(self, name: _Optional[str] = ..., model: _Optional[str] = ..., gamma: _Optional[float] = ..., reflectivity: _Optional[float] = ..., rms_slope: _Optional[float] = ..., plate_tau: _Optional[float] = ..., plate_exponent: _Optional[float] = ...) -> None: ...

class PlatformState(_message.Message):
    __slots__ = ["platform", "pose"]
    PLATFORM_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    platform: str
    pose: Pose
    def __init__(self, platform: _Optional[str] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ...) -> None: ...

class Pose(_message.Message):
    __slots__ = ["bearing_deg", "geoid_undulation_m", "heading_deg", "height_m", "height_reference", "latitude_deg", "longitude_deg", "new_time_line", "pitch_deg", "pose_id", "roll_deg", "sim_time_ns", "tilt_auto", "tilt_deg", "time_rate", "valid_s", "velocity_east_m_s", "velocity_north_m_s", "velocity_up_m_s"]
    BEARING_DEG_FIELD_NUMBER: _ClassVar[int]
    GEOID_UNDULATION_M_FIELD_NUMBER: _ClassVar[int]
    HEADING_DEG_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_M_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_REFERENCE_FIELD_NUMBER: _ClassVar[int]
    LATITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    LONGITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    NEW_TIME_LINE_FIELD_NUMBER: _ClassVar[int]
    PITCH_DEG_FIELD_NUMBER: _ClassVar[int]
    POSE_ID_FIELD_NUMBER: _ClassVar[int]
    ROLL_DEG_FIELD_NUMBER: _ClassVar[int]
    SIM_TIME_NS_FIELD_NUMBER: _ClassVar[int]
    TILT_AUTO_FIELD_NUMBER: _ClassVar[int]
    TILT_DEG_FIELD_NUMBER: _ClassVar[int]
    TIME_RATE_FIELD_NUMBER: _ClassVar[int]
    VALID_S_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_EAST_M_S_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_NORTH_M_S_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_UP_M_S_FIELD_NUMBER: _ClassVar[int]
    bearing_deg: float
    geoid_undulation_m: float
    heading_deg: float
    height_m: float
    height_reference: HeightReference
    latitude_deg: float
    longitude_deg: float
    new_time_line: bool
    pitch_deg: float
    pose_id: int
    roll_deg: float
    sim_time_ns: int
    tilt_auto: bool
    tilt_deg: float
    time_rate: float
    valid_s: float
    velocity_east_m_s: float
    velocity_north_m_s: float
    velocity_up_m_s: float
    def __init__(self, latitude_deg: _Optional[float] = ..., longitude_deg: _Optional[float] = ..., height_m: _Optional[float] = ..., height_reference: _Optional[_Union[HeightReference, str]] = ..., geoid_undulation_m: _Optional[float] = ..., bearing_deg: _Optional[float] = ..., sim_time_ns: _Optional[int] = ..., pose_id: _Optional[int] = ..., valid_s: _Optional[float] = ..., tilt_deg: _Optional[float] = ..., tilt_auto: bool = ..., velocity_north_m_s: _Optional[float] = ..., velocity_east_m_s: _Optional[float] = ..., velocity_up_m_s: _Optional[float] = ..., roll_deg: _Optional[float] = ..., pitch_deg: _Optional[float] = ..., heading_deg: _Optional[float] = ..., new_time_line: bool = ..., time_rate: _Optional[float] = ...) -> None: ...

class PulseStagger(_message.Message):
    __slots__ = ["ratio"]
    RATIO_FIELD_NUMBER: _ClassVar[int]
    ratio: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, ratio: _Optional[_Iterable[float]] = ...) -> None: ...

class QueryGround(_message.Message):
    __slots__ = ["antenna", "bearing_deg", "geoid_undulation_m", "height_m", "height_reference", "latitude_deg", "longitude_deg", "radar", "range_m", "request_id"]
    ANTENNA_FIELD_NUMBER: _ClassVar[int]
    BEARING_DEG_FIELD_NUMBER: _ClassVar[int]
    GEOID_UNDULATION_M_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_M_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_REFERENCE_FIELD_NUMBER: _ClassVar[int]
    LATITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    LONGITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RANGE_M_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    antenna: Pose
    bearing_deg: _containers.RepeatedScalarFieldContainer[float]
    geoid_undulation_m: float
    height_m: _containers.RepeatedScalarFieldContainer[float]
    height_reference: HeightReference
    latitude_deg: _containers.RepeatedScalarFieldContainer[float]
    longitude_deg: _containers.RepeatedScalarFieldContainer[float]
    radar: str
    range_m: _containers.RepeatedScalarFieldContainer[float]
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., antenna: _Optional[_Union[Pose, _Mapping]] = ..., latitude_deg: _Optional[_Iterable[float]] = ..., longitude_deg: _Optional[_Iterable[float]] = ..., bearing_deg: _Optional[_Iterable[float]] = ..., range_m: _Optional[_Iterable[float]] = ..., height_m: _Optional[_Iterable[float]] = ..., height_reference: _Optional[_Union[HeightReference, str]] = ..., geoid_undulation_m: _Optional[float] = ...) -> None: ...

class RadarInfo(_message.Message):
    __slots__ = ["claimed_by_you", "controlled_by_you", "controller", "exercise_frozen", "fault", "frozen", "gimbal", "late_poses", "platform", "pose", "pose_stale", "radar", "rate_hz", "rate_limit_hz", "request_id", "riders", "settings", "settings_controller", "settings_version", "subscribers", "transmit_off"]
    CLAIMED_BY_YOU_FIELD_NUMBER: _ClassVar[int]
    CONTROLLED_BY_YOU_FIELD_NUMBER: _ClassVar[int]
    CONTROLLER_FIELD_NUMBER: _ClassVar[int]
    EXERCISE_FROZEN_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    FROZEN_FIELD_NUMBER: _ClassVar[int]
    GIMBAL_FIELD_NUMBER: _ClassVar[int]
    LATE_POSES_FIELD_NUMBER: _ClassVar[int]
    PLATFORM_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    POSE_STALE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RATE_HZ_FIELD_NUMBER: _ClassVar[int]
    RATE_LIMIT_HZ_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    RIDERS_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_CONTROLLER_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_VERSION_FIELD_NUMBER: _ClassVar[int]
    SUBSCRIBERS_FIELD_NUMBER: _ClassVar[int]
    TRANSMIT_OFF_FIELD_NUMBER: _ClassVar[int]
    claimed_by_you: _containers.RepeatedScalarFieldContainer[ClaimKind]
    controlled_by_you: bool
    controller: str
    exercise_frozen: bool
    fault: str
    frozen: bool
    gimbal: str
    late_poses: int
    platform: str
    pose: Pose
    pose_stale: bool
    radar: str
    rate_hz: float
    rate_limit_hz: float
    request_id: int
    riders: _containers.RepeatedScalarFieldContainer[str]
    settings: RadarSettings
    settings_controller: str
    settings_version: int
    subscribers: int
    transmit_off: bool
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., settings: _Optional[_Union[RadarSettings, _Mapping]] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., settings_version: _Optional[int] = ..., controller: _Optional[str] = ..., controlled_by_you: bool = ..., subscribers: _Optional[int] = ..., rate_hz: _Optional[float] = ..., fault: _Optional[str] = ..., pose_stale: bool = ..., late_poses: _Optional[int] = ..., transmit_off: bool = ..., frozen: bool = ..., rate_limit_hz: _Optional[float] = ..., settings_controller: _Optional[str] = ..., claimed_by_you: _Optional[_Iterable[_Union[ClaimKind, str]]] = ..., exercise_frozen: bool = ..., platform: _Optional[str] = ..., riders: _Optional[_Iterable[str]] = ..., gimbal: _Optional[str] = ...) -> None: ...

class RadarList(_message.Message):
    __slots__ = ["platforms", "radars", "request_id"]
    PLATFORMS_FIELD_NUMBER: _ClassVar[int]
    RADARS_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    platforms: _containers.RepeatedScalarFieldContainer[str]
    radars: _containers.RepeatedScalarFieldContainer[str]
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radars: _Optional[_Iterable[str]] = ..., platforms: _Optional[_Iterable[str]] = ...) -> None: ...

class RadarSettings(_message.Message):
    __slots__ = ["adc_bits", "antenna_temperature_k", "azimuth_bins", "beam_cosecant_to_deg", "beam_elevation", "beam_elevation_width_deg", "beam_extent_deg", "beam_nbar", "beam_pattern", "beam_sidelobe_db", "beam_stabilised", "beam_width_deg", "canceller", "clutter_lock", "doppler_pulses", "doppler_window", "frequency_ghz", "frustum", "ftc_us", "full_scale_dbm", "gain_db", "gas", "loss_db", "mode", "noise", "noise_figure_db", "noise_frame", "noise_seed", "pixel_columns", "pixel_rows", "planes_per_bin", "plates", "polarisation", "power_w", "prf_hz", "pulse_bandwidth_mhz", "pulse_eclipse", "pulse_extent_bins", "pulse_kind", "pulse_length_us", "pulse_nbar", "pulse_sidelobe_db", "pulse_stagger", "pulse_window", "r_max_m", "r_min_m", "rain_mm_h", "rain_top_m", "range_bins", "range_normalisation", "receiver_gain_db", "resolution_m", "scan_bars", "scan_dwell_bins", "scan_mode", "scan_rate_deg_s", "sea_shape", "sea_state", "sea_state_auto", "sector_deg", "speckle", "speckle_seed", "stc_db", "stc_power", "stc_range_m", "sub_columns", "video_floor_auto", "video_floor_db", "video_looks", "video_span_db", "wind_from_deg", "wind_m_s"]
    ADC_BITS_FIELD_NUMBER: _ClassVar[int]
    ANTENNA_TEMPERATURE_K_FIELD_NUMBER: _ClassVar[int]
    AZIMUTH_BINS_FIELD_NUMBER: _ClassVar[int]
    BEAM_COSECANT_TO_DEG_FIELD_NUMBER: _ClassVar[int]
    BEAM_ELEVATION_FIELD_NUMBER: _ClassVar[int]
    BEAM_ELEVATION_WIDTH_DEG_FIELD_NUMBER: _ClassVar[int]
    BEAM_EXTENT_DEG_FIELD_NUMBER: _ClassVar[int]
    BEAM_NBAR_FIELD_NUMBER: _ClassVar[int]
    BEAM_PATTERN_FIELD_NUMBER: _ClassVar[int]
    BEAM_SIDELOBE_DB_FIELD_NUMBER: _ClassVar[int]
    BEAM_STABILISED_FIELD_NUMBER: _ClassVar[int]
    BEAM_WIDTH_DEG_FIELD_NUMBER: _ClassVar[int]
    CANCELLER_FIELD_NUMBER: _ClassVar[int]
    CLUTTER_LOCK_FIELD_NUMBER: _ClassVar[int]
    DOPPLER_PULSES_FIELD_NUMBER: _ClassVar[int]
    DOPPLER_WINDOW_FIELD_NUMBER: _ClassVar[int]
    FREQUENCY_GHZ_FIELD_NUMBER: _ClassVar[int]
    FRUSTUM_FIELD_NUMBER: _ClassVar[int]
    FTC_US_FIELD_NUMBER: _ClassVar[int]
    FULL_SCALE_DBM_FIELD_NUMBER: _ClassVar[int]
    GAIN_DB_FIELD_NUMBER: _ClassVar[int]
    GAS_FIELD_NUMBER: _ClassVar[int]
    LOSS_DB_FIELD_NUMBER: _ClassVar[int]
    MODE_FIELD_NUMBER: _ClassVar[int]
    NOISE_FIELD_NUMBER: _ClassVar[int]
    NOISE_FIGURE_DB_FIELD_NUMBER: _ClassVar[int]
    NOISE_FRAME_FIELD_NUMBER: _ClassVar[int]
    NOISE_SEED_FIELD_NUMBER: _ClassVar[int]
    PIXEL_COLUMNS_FIELD_NUMBER: _ClassVar[int]
    PIXEL_ROWS_FIELD_NUMBER: _ClassVar[int]
    PLANES_PER_BIN_FIELD_NUMBER: _ClassVar[int]
    PLATES_FIELD_NUMBER: _ClassVar[int]
    POLARISATION_FIELD_NUMBER: _ClassVar[int]
    POWER_W_FIELD_NUMBER: _ClassVar[int]
    PRF_HZ_FIELD_NUMBER: _ClassVar[int]
    PULSE_BANDWIDTH_MHZ_FIELD_NUMBER: _ClassVar[int]
    PULSE_ECLIPSE_FIELD_NUMBER: _ClassVar[int]
    PULSE_EXTENT_BINS_FIELD_NUMBER: _ClassVar[int]
    PULSE_KIND_FIELD_NUMBER: _ClassVar[int]
    PULSE_LENGTH_US_FIELD_NUMBER: _ClassVar[int]
    PULSE_NBAR_FIELD_NUMBER: _ClassVar[int]
    PULSE_SIDELOBE_DB_FIELD_NUMBER: _ClassVar[int]
    PULSE_STAGGER_FIELD_NUMBER: _ClassVar[int]
    PULSE_WINDOW_FIELD_NUMBER: _ClassVar[int]
    RAIN_MM_H_FIELD_NUMBER: _ClassVar[int]
    RAIN_TOP_M_FIELD_NUMBER: _ClassVar[int]
    RANGE_BINS_FIELD_NUMBER: _ClassVar[int]
    RANGE_NORMALISATION_FIELD_NUMBER: _ClassVar[int]
    RECEIVER_GAIN_DB_FIELD_NUMBER: _ClassVar[int]
    RESOLUTION_M_FIELD_NUMBER: _ClassVar[int]
    R_MAX_M_FIELD_NUMBER: _ClassVar[int]
    R_MIN_M_FIELD_NUMBER: _ClassVar[int]
    SCAN_BARS_FIELD_NUMBER: _ClassVar[int]
    SCAN_DWELL_BINS_FIELD_NUMBER: _ClassVar[int]
    SCAN_MODE_FIELD_NUMBER: _ClassVar[int]
    SCAN_RATE_DEG_S_FIELD_NUMBER: _ClassVar[int]
    SEA_SHAPE_FIELD_NUMBER: _ClassVar[int]
    SEA_STATE_AUTO_FIELD_NUMBER: _ClassVar[int]
    SEA_STATE_FIELD_NUMBER: _ClassVar[int]
    SECTOR_DEG_FIELD_NUMBER: _ClassVar[int]
    SPECKLE_FIELD_NUMBER: _ClassVar[int]
    SPECKLE_SEED_FIELD_NUMBER: _ClassVar[int]
    STC_DB_FIELD_NUMBER: _ClassVar[int]
    STC_POWER_FIELD_NUMBER: _ClassVar[int]
    STC_RANGE_M_FIELD_NUMBER: _ClassVar[int]
    SUB_COLUMNS_FIELD_NUMBER: _ClassVar[int]
    VIDEO_FLOOR_AUTO_FIELD_NUMBER: _ClassVar[int]
    VIDEO_FLOOR_DB_FIELD_NUMBER: _ClassVar[int]
    VIDEO_LOOKS_FIELD_NUMBER: _ClassVar[int]
    VIDEO_SPAN_DB_FIELD_NUMBER: _ClassVar[int]
    WIND_FROM_DEG_FIELD_NUMBER: _ClassVar[int]
    WIND_M_S_FIELD_NUMBER: _ClassVar[int]
    adc_bits: int
    antenna_temperature_k: float
    azimuth_bins: int
    beam_cosecant_to_deg: float
    beam_elevation: ElevationPattern
    beam_elevation_width_deg: float
    beam_extent_deg: float
    beam_nbar: int
    beam_pattern: BeamPattern
    beam_sidelobe_db: float
    beam_stabilised: bool
    beam_width_deg: float
    canceller: int
    clutter_lock: bool
    doppler_pulses: int
    doppler_window: DopplerWindow
    frequency_ghz: float
    frustum: FrustumKind
    ftc_us: float
    full_scale_dbm: float
    gain_db: float
    gas: bool
    loss_db: float
    mode: RadarMode
    noise: bool
    noise_figure_db: float
    noise_frame: int
    noise_seed: int
    pixel_columns: int
    pixel_rows: int
    planes_per_bin: int
    plates: PlateKind
    polarisation: Polarisation
    power_w: float
    prf_hz: float
    pulse_bandwidth_mhz: float
    pulse_eclipse: bool
    pulse_extent_bins: int
    pulse_kind: PulseKind
    pulse_length_us: float
    pulse_nbar: int
    pulse_sidelobe_db: float
    pulse_stagger: PulseStagger
    pulse_window: PulseWindow
    r_max_m: float
    r_min_m: float
    rain_mm_h: float
    rain_top_m: float
    range_bins: int
    range_normalisation: bool
    receiver_gain_db: float
    resolution_m: float
    scan_bars: ScanBars
    scan_dwell_bins: int
    scan_mode: ScanMode
    scan_rate_deg_s: float
    sea_shape: float
    sea_state: float
    sea_state_auto: bool
    sector_deg: float
    speckle: SpeckleKind
    speckle_seed: int
    stc_db: float
    stc_power: float
    stc_range_m: float
    sub_columns: int
    video_floor_auto: bool
    video_floor_db: float
    video_looks: int
    video_span_db: float
    wind_from_deg: float
    wind_m_s: float
    def __init__(self, frequency_ghz: _Optional[float] = ..., sector_deg: _Optional[float] = ..., r_min_m: _Optional[float] = ..., r_max_m: _Optional[float] = ..., power_w: _Optional[float] = ..., gain_db: _Optional[float] = ..., range_normalisation: bool = ..., speckle: _Optional[_Union[SpeckleKind, str]] = ..., speckle_seed: _Optional[int] = ..., frustum: _Optional[_Union[FrustumKind, str]] = ..., pixel_columns: _Optional[int] = ..., pixel_rows: _Optional[int] = ..., azimuth_bins: _Optional[int] = ..., range_bins: _Optional[int] = ..., plates: _Optional[_Union[PlateKind, str]] = ..., scan_mode: _Optional[_Union[ScanMode, str]] = ..., scan_rate_deg_s: _Optional[float] = ..., scan_dwell_bins: _Optional[int] = ..., scan_bars: _Optional[_Union[ScanBars, _Mapping]] = ..., sub_columns: _Optional[int] = ..., beam_pattern: _Optional[_Union[BeamPattern, str]] = ..., beam_width_deg: _Optional[float] = ..., beam_sidelobe_db: _Optional[float] = ..., beam_nbar: _Optional[int] = ..., beam_extent_deg: _Optional[float] = ..., beam_elevation: _Optional[_Union[ElevationPattern, str]] = ..., beam_elevation_width_deg: _Optional[float] = ..., beam_cosecant_to_deg: _Optional[float] = ..., pulse_kind: _Optional[_Union[PulseKind, str]] = ..., pulse_length_us: _Optional[float] = ..., pulse_bandwidth_mhz: _Optional[float] = ..., pulse_window: _Optional[_Union[PulseWindow, str]] = ..., pulse_sidelobe_db: _Optional[float] = ..., pulse_nbar: _Optional[int] = ..., pulse_extent_bins: _Optional[int] = ..., pulse_eclipse: bool = ..., noise: bool = ..., noise_figure_db: _Optional[float] = ..., antenna_temperature_k: _Optional[float] = ..., loss_db: _Optional[float] = ..., noise_seed: _Optional[int] = ..., noise_frame: _Optional[int] = ..., receiver_gain_db: _Optional[float] = ..., stc_range_m: _Optional[float] = ..., stc_power: _Optional[float] = ..., stc_db: _Optional[float] = ..., adc_bits: _Optional[int] = ..., full_scale_dbm: _Optional[float] = ..., video_looks: _Optional[int] = ..., video_floor_auto: bool = ..., video_floor_db: _Optional[float] = ..., video_span_db: _Optional[float] = ..., rain_mm_h: _Optional[float] = ..., rain_top_m: _Optional[float] = ..., gas: bool = ..., polarisation: _Optional[_Union[Polarisation, str]] = ..., planes_per_bin: _Optional[int] = ..., beam_stabilised: bool = ..., mode: _Optional[_Union[RadarMode, str]] = ..., prf_hz: _Optional[float] = ..., doppler_pulses: _Optional[int] = ..., doppler_window: _Optional[_Union[DopplerWindow, str]] = ..., canceller: _Optional[int] = ..., clutter_lock: bool = ..., wind_m_s: _Optional[float] = ..., resolution_m: _Optional[float] = ..., pulse_stagger: _Optional[_Union[PulseStagger, _Mapping]] = ..., sea_state: _Optional[float] = ..., sea_shape: _Optional[float] = ..., wind_from_deg: _Optional[float] = ..., sea_state_auto: bool = ..., ftc_us: _Optional[float] = ...) -> None: ...

class RadarState(_message.Message):
    __slots__ = ["frozen", "pose", "radar", "rate_limit_hz", "settings", "transmit_off"]
    FROZEN_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RATE_LIMIT_HZ_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_FIELD_NUMBER: _ClassVar[int]
    TRANSMIT_OFF_FIELD_NUMBER: _ClassVar[int]
    frozen: bool
    pose: Pose
    radar: str
    rate_limit_hz: float
    settings: RadarSettings
    transmit_off: bool
    def __init__(self, radar: _Optional[str] = ..., settings: _Optional[_Union[RadarSettings, _Mapping]] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., transmit_off: bool = ..., frozen: bool = ..., rate_limit_hz: _Optional[float] = ...) -> None: ...

class RadarStatus(_message.Message):
    __slots__ = ["controller", "coverage", "coverage_reason", "dwells_missed", "fault", "frames", "frames_shed", "frames_skipped", "frozen", "gimbal", "last_render_s", "late_poses", "live_bytes", "live_frames", "platform", "pose_stale", "radar", "rate_hz", "rate_limit_hz", "settings_controller", "settings_version", "subscribers", "transmit_off"]
    CONTROLLER_FIELD_NUMBER: _ClassVar[int]
    COVERAGE_FIELD_NUMBER: _ClassVar[int]
    COVERAGE_REASON_FIELD_NUMBER: _ClassVar[int]
    DWELLS_MISSED_FIELD_NUMBER: _ClassVar[int]
    FAULT_FIELD_NUMBER: _ClassVar[int]
    FRAMES_FIELD_NUMBER: _ClassVar[int]
    FRAMES_SHED_FIELD_NUMBER: _ClassVar[int]
    FRAMES_SKIPPED_FIELD_NUMBER: _ClassVar[int]
    FROZEN_FIELD_NUMBER: _ClassVar[int]
    GIMBAL_FIELD_NUMBER: _ClassVar[int]
    LAST_RENDER_S_FIELD_NUMBER: _ClassVar[int]
    LATE_POSES_FIELD_NUMBER: _ClassVar[int]
    LIVE_BYTES_FIELD_NUMBER: _ClassVar[int]
    LIVE_FRAMES_FIELD_NUMBER: _ClassVar[int]
    PLATFORM_FIELD_NUMBER: _ClassVar[int]
    POSE_STALE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RATE_HZ_FIELD_NUMBER: _ClassVar[int]
    RATE_LIMIT_HZ_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_CONTROLLER_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_VERSION_FIELD_NUMBER: _ClassVar[int]
    SUBSCRIBERS_FIELD_NUMBER: _ClassVar[int]
    TRANSMIT_OFF_FIELD_NUMBER: _ClassVar[int]
    controller: str
    coverage: float
    coverage_reason: str
    dwells_missed: int
    fault: str
    frames: int
    frames_shed: int
    frames_skipped: int
    frozen: bool
    gimbal: str
    last_render_s: float
    late_poses: int
    live_bytes: int
    live_frames: int
    platform: str
    pose_stale: bool
    radar: str
    rate_hz: float
    rate_limit_hz: float
    settings_controller: str
    settings_version: int
    subscribers: int
    transmit_off: bool
    def __init__(self, radar: _Optional[str] = ..., controller: _Optional[str] = ..., subscribers: _Optional[int] = ..., rate_hz: _Optional[float] = ..., frames: _Optional[int] = ..., last_render_s: _Optional[float] = ..., settings_version: _Optional[int] = ..., fault: _Optional[str] = ..., live_frames: _Optional[int] = ..., live_bytes: _Optional[int] = ..., frames_skipped: _Optional[int] = ..., frames_shed: _Optional[int] = ..., pose_stale: bool = ..., late_poses: _Optional[int] = ..., dwells_missed: _Optional[int] = ..., coverage: _Optional[float] = ..., coverage_reason: _Optional[str] = ..., transmit_off: bool = ..., frozen: bool = ..., rate_limit_hz: _Optional[float] = ..., settings_controller: _Optional[str] = ..., platform: _Optional[str] = ..., gimbal: _Optional[str] = ...) -> None: ...

class ReleaseControl(_message.Message):
    __slots__ = ["kinds", "radar", "request_id"]
    KINDS_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    kinds: _containers.RepeatedScalarFieldContainer[ClaimKind]
    radar: str
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., kinds: _Optional[_Iterable[_Union[ClaimKind, str]]] = ...) -> None: ...

class RenderOnce(_message.Message):
    __slots__ = ["as_live", "compression", "iq_encoding", "live_targets", "planes", "pose", "radar", "request_id", "settings", "targets", "truth", "video_bits", "window"]
    AS_LIVE_FIELD_NUMBER: _ClassVar[int]
    COMPRESSION_FIELD_NUMBER: _ClassVar[int]
    IQ_ENCODING_FIELD_NUMBER: _ClassVar[int]
    LIVE_TARGETS_FIELD_NUMBER: _ClassVar[int]
    PLANES_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_FIELD_NUMBER: _ClassVar[int]
    TARGETS_FIELD_NUMBER: _ClassVar[int]
    TRUTH_FIELD_NUMBER: _ClassVar[int]
    VIDEO_BITS_FIELD_NUMBER: _ClassVar[int]
    WINDOW_FIELD_NUMBER: _ClassVar[int]
    as_live: bool
    compression: CompressionKind
    iq_encoding: IqEncodingKind
    live_targets: bool
    planes: _containers.RepeatedScalarFieldContainer[PlaneKind]
    pose: Pose
    radar: str
    request_id: int
    settings: RadarSettings
    targets: _containers.RepeatedCompositeFieldContainer[Target]
    truth: bool
    video_bits: int
    window: BinWindow
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., settings: _Optional[_Union[RadarSettings, _Mapping]] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., planes: _Optional[_Iterable[_Union[PlaneKind, str]]] = ..., iq_encoding: _Optional[_Union[IqEncodingKind, str]] = ..., compression: _Optional[_Union[CompressionKind, str]] = ..., window: _Optional[_Union[BinWindow, _Mapping]] = ..., video_bits: _Optional[int] = ..., as_live: bool = ..., targets: _Optional[_Iterable[_Union[Target, _Mapping]]] = ..., live_targets: bool = ..., truth: bool = ...) -> None: ...

class ReplayState(_message.Message):
    __slots__ = ["duration_s", "ended", "loop", "paused", "position_s", "radar", "running", "seeks", "sim_time_ns", "speed", "start_utc_ns"]
    DURATION_S_FIELD_NUMBER: _ClassVar[int]
    ENDED_FIELD_NUMBER: _ClassVar[int]
    LOOP_FIELD_NUMBER: _ClassVar[int]
    PAUSED_FIELD_NUMBER: _ClassVar[int]
    POSITION_S_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RUNNING_FIELD_NUMBER: _ClassVar[int]
    SEEKS_FIELD_NUMBER: _ClassVar[int]
    SIM_TIME_NS_FIELD_NUMBER: _ClassVar[int]
    SPEED_FIELD_NUMBER: _ClassVar[int]
    START_UTC_NS_FIELD_NUMBER: _ClassVar[int]
    duration_s: float
    ended: bool
    loop: bool
    paused: bool
    position_s: float
    radar: str
    running: bool
    seeks: int
    sim_time_ns: int
    speed: float
    start_utc_ns: int
    def __init__(self, radar: _Optional[str] = ..., start_utc_ns: _Optional[int] = ..., duration_s: _Optional[float] = ..., position_s: _Optional[float] = ..., speed: _Optional[float] = ..., paused: bool = ..., running: bool = ..., loop: bool = ..., ended: bool = ..., sim_time_ns: _Optional[int] = ..., seeks: _Optional[int] = ...) -> None: ...

class ResetExercise(_message.Message):
    __slots__ = ["radar", "request_id"]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    radar: str
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ...) -> None: ...

class ScanBars(_message.Message):
    __slots__ = ["tilt_deg"]
    TILT_DEG_FIELD_NUMBER: _ClassVar[int]
    tilt_deg: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, tilt_deg: _Optional[_Iterable[float]] = ...) -> None: ...

class ScanPass(_message.Message):
    __slots__ = ["begin_ns", "clockwise", "dwell_bins", "mode", "rate_deg_s"]
    BEGIN_NS_FIELD_NUMBER: _ClassVar[int]
    CLOCKWISE_FIELD_NUMBER: _ClassVar[int]
    DWELL_BINS_FIELD_NUMBER: _ClassVar[int]
    MODE_FIELD_NUMBER: _ClassVar[int]
    RATE_DEG_S_FIELD_NUMBER: _ClassVar[int]
    begin_ns: int
    clockwise: bool
    dwell_bins: int
    mode: ScanMode
    rate_deg_s: float
    def __init__(self, mode: _Optional[_Union[ScanMode, str]] = ..., clockwise: bool = ..., rate_deg_s: _Optional[float] = ..., dwell_bins: _Optional[int] = ..., begin_ns: _Optional[int] = ...) -> None: ...

class SetExercise(_message.Message):
    __slots__ = ["frozen", "request_id"]
    FROZEN_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    frozen: bool
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., frozen: bool = ...) -> None: ...

class SetPose(_message.Message):
    __slots__ = ["pose", "radar", "request_id"]
    POSE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    pose: Pose
    radar: str
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ...) -> None: ...

class SetReplay(_message.Message):
    __slots__ = ["paused", "request_id", "seek_bookmark", "seek_s", "seek_sim_time_ns", "speed"]
    PAUSED_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SEEK_BOOKMARK_FIELD_NUMBER: _ClassVar[int]
    SEEK_SIM_TIME_NS_FIELD_NUMBER: _ClassVar[int]
    SEEK_S_FIELD_NUMBER: _ClassVar[int]
    SPEED_FIELD_NUMBER: _ClassVar[int]
    paused: bool
    request_id: int
    seek_bookmark: int
    seek_s: float
    seek_sim_time_ns: int
    speed: float
    def __init__(self, request_id: _Optional[int] = ..., paused: bool = ..., speed: _Optional[float] = ..., seek_s: _Optional[float] = ..., seek_bookmark: _Optional[int] = ..., seek_sim_time_ns: _Optional[int] = ...) -> None: ...

class SetSettings(_message.Message):
    __slots__ = ["radar", "request_id", "settings"]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_FIELD_NUMBER: _ClassVar[int]
    radar: str
    request_id: int
    settings: RadarSettings
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., settings: _Optional[_Union[RadarSettings, _Mapping]] = ...) -> None: ...

class SetState(_message.Message):
    __slots__ = ["freeze", "radar", "request_id", "transmit"]
    FREEZE_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TRANSMIT_FIELD_NUMBER: _ClassVar[int]
    freeze: bool
    radar: str
    request_id: int
    transmit: bool
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., transmit: bool = ..., freeze: bool = ...) -> None: ...

class SetTargets(_message.Message):
    __slots__ = ["clear", "gone", "more", "request_id", "targets"]
    CLEAR_FIELD_NUMBER: _ClassVar[int]
    GONE_FIELD_NUMBER: _ClassVar[int]
    MORE_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TARGETS_FIELD_NUMBER: _ClassVar[int]
    clear: bool
    gone: _containers.RepeatedScalarFieldContainer[int]
    more: bool
    request_id: int
    targets: _containers.RepeatedCompositeFieldContainer[Target]
    def __init__(self, request_id: _Optional[int] = ..., targets: _Optional[_Iterable[_Union[Target, _Mapping]]] = ..., gone: _Optional[_Iterable[int]] = ..., clear: bool = ..., more: bool = ...) -> None: ...

class SourceError(_message.Message):
    __slots__ = ["greatest_m", "median_m", "p95_m", "posts", "rms_m"]
    GREATEST_M_FIELD_NUMBER: _ClassVar[int]
    MEDIAN_M_FIELD_NUMBER: _ClassVar[int]
    P95_M_FIELD_NUMBER: _ClassVar[int]
    POSTS_FIELD_NUMBER: _ClassVar[int]
    RMS_M_FIELD_NUMBER: _ClassVar[int]
    greatest_m: float
    median_m: float
    p95_m: float
    posts: int
    rms_m: float
    def __init__(self, posts: _Optional[int] = ..., median_m: _Optional[float] = ..., p95_m: _Optional[float] = ..., rms_m: _Optional[float] = ..., greatest_m: _Optional[float] = ...) -> None: ...

class Status(_message.Message):
    __slots__ = ["bytes_sent", "clients", "exercise_frozen", "frames_dropped", "max_targets", "radars", "renders_queued", "request_id", "server_name", "server_version", "targets", "targets_controller", "targets_expired", "targets_late", "uptime_s", "window_error", "window_failure", "window_failures", "window_loading", "window_well_s", "windows_loaded"]
    BYTES_SENT_FIELD_NUMBER: _ClassVar[int]
    CLIENTS_FIELD_NUMBER: _ClassVar[int]
    EXERCISE_FROZEN_FIELD_NUMBER: _ClassVar[int]
    FRAMES_DROPPED_FIELD_NUMBER: _ClassVar[int]
    MAX_TARGETS_FIELD_NUMBER: _ClassVar[int]
    RADARS_FIELD_NUMBER: _ClassVar[int]
    RENDERS_QUEUED_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    SERVER_NAME_FIELD_NUMBER: _ClassVar[int]
    SERVER_VERSION_FIELD_NUMBER: _ClassVar[int]
    TARGETS_CONTROLLER_FIELD_NUMBER: _ClassVar[int]
    TARGETS_EXPIRED_FIELD_NUMBER: _ClassVar[int]
    TARGETS_FIELD_NUMBER: _ClassVar[int]
    TARGETS_LATE_FIELD_NUMBER: _ClassVar[int]
    UPTIME_S_FIELD_NUMBER: _ClassVar[int]
    WINDOWS_LOADED_FIELD_NUMBER: _ClassVar[int]
    WINDOW_ERROR_FIELD_NUMBER: _ClassVar[int]
    WINDOW_FAILURES_FIELD_NUMBER: _ClassVar[int]
    WINDOW_FAILURE_FIELD_NUMBER: _ClassVar[int]
    WINDOW_LOADING_FIELD_NUMBER: _ClassVar[int]
    WINDOW_WELL_S_FIELD_NUMBER: _ClassVar[int]
    bytes_sent: int
    clients: int
    exercise_frozen: bool
    frames_dropped: int
    max_targets: int
    radars: _containers.RepeatedCompositeFieldContainer[RadarStatus]
    renders_queued: int
    request_id: int
    server_name: str
    server_version: str
    targets: int
    targets_controller: str
    targets_expired: int
    targets_late: int
    uptime_s: float
    window_error: str
    window_failure: str
    window_failures: int
    window_loading: bool
    window_well_s: float
    windows_loaded: int
    def __init__(self, request_id: _Optional[int] = ..., server_name: _Optional[str] = ..., server_version: _Optional[str] = ..., uptime_s: _Optional[float] = ..., clients: _Optional[int] = ..., frames_dropped: _Optional[int] = ..., bytes_sent: _Optional[int] = ..., renders_queued: _Optional[int] = ..., radars: _Optional[_Iterable[_Union[RadarStatus, _Mapping]]] = ..., windows_loaded: _Optional[int] = ..., window_loading: bool = ..., window_failures: _Optional[int] = ..., window_error: _Optional[str] = ..., window_failure: _Optional[str] = ..., window_well_s: _Optional[float] = ..., exercise_frozen: bool = ..., targets: _Optional[int] = ..., max_targets: _Optional[int] = ..., targets_controller: _Optional[str] = ..., targets_expired: _Optional[int] = ..., targets_late: _Optional[int] = ...) -> None: ...

class Subscribe(_message.Message):
    __slots__ = ["compression", "iq_encoding", "lossless", "planes", "radar", "rate_hz", "request_id", "truth", "video_bits", "window"]
    COMPRESSION_FIELD_NUMBER: _ClassVar[int]
    IQ_ENCODING_FIELD_NUMBER: _ClassVar[int]
    LOSSLESS_FIELD_NUMBER: _ClassVar[int]
    PLANES_FIELD_NUMBER: _ClassVar[int]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    RATE_HZ_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TRUTH_FIELD_NUMBER: _ClassVar[int]
    VIDEO_BITS_FIELD_NUMBER: _ClassVar[int]
    WINDOW_FIELD_NUMBER: _ClassVar[int]
    compression: CompressionKind
    iq_encoding: IqEncodingKind
    lossless: bool
    planes: _containers.RepeatedScalarFieldContainer[PlaneKind]
    radar: str
    rate_hz: float
    request_id: int
    truth: bool
    video_bits: int
    window: BinWindow
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ..., rate_hz: _Optional[float] = ..., planes: _Optional[_Iterable[_Union[PlaneKind, str]]] = ..., iq_encoding: _Optional[_Union[IqEncodingKind, str]] = ..., compression: _Optional[_Union[CompressionKind, str]] = ..., window: _Optional[_Union[BinWindow, _Mapping]] = ..., video_bits: _Optional[int] = ..., lossless: bool = ..., truth: bool = ...) -> None: ...

class Target(_message.Message):
    __slots__ = ["acceleration_east_m_s2", "acceleration_north_m_s2", "acceleration_up_m_s2", "age_s", "geoid_undulation_m", "heading_deg", "heading_rate_deg_s", "height_m", "height_reference", "id", "latitude_deg", "length_m", "longitude_deg", "name", "rcs_dbsm", "route", "sim_time_ns", "swerling", "top_m", "type", "valid_s", "velocity_east_m_s", "velocity_north_m_s", "velocity_up_m_s", "width_m"]
    ACCELERATION_EAST_M_S2_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_NORTH_M_S2_FIELD_NUMBER: _ClassVar[int]
    ACCELERATION_UP_M_S2_FIELD_NUMBER: _ClassVar[int]
    AGE_S_FIELD_NUMBER: _ClassVar[int]
    GEOID_UNDULATION_M_FIELD_NUMBER: _ClassVar[int]
    HEADING_DEG_FIELD_NUMBER: _ClassVar[int]
    HEADING_RATE_DEG_S_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_M_FIELD_NUMBER: _ClassVar[int]
    HEIGHT_REFERENCE_FIELD_NUMBER: _ClassVar[int]
    ID_FIELD_NUMBER: _ClassVar[int]
    LATITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    LENGTH_M_FIELD_NUMBER: _ClassVar[int]
    LONGITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    RCS_DBSM_FIELD_NUMBER: _ClassVar[int]
    ROUTE_FIELD_NUMBER: _ClassVar[int]
    SIM_TIME_NS_FIELD_NUMBER: _ClassVar[int]
    SWERLING_FIELD_NUMBER: _ClassVar[int]
    TOP_M_FIELD_NUMBER: _ClassVar[int]
    TYPE_FIELD_NUMBER: _ClassVar[int]
    VALID_S_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_EAST_M_S_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_NORTH_M_S_FIELD_NUMBER: _ClassVar[int]
    VELOCITY_UP_M_S_FIELD_NUMBER: _ClassVar[int]
    WIDTH_M_FIELD_NUMBER: _ClassVar[int]
    acceleration_east_m_s2: float
    acceleration_north_m_s2: float
    acceleration_up_m_s2: float
    age_s: float
    geoid_undulation_m: float
    heading_deg: float
    heading_rate_deg_s: float
    height_m: float
    height_reference: HeightReference
    id: int
    latitude_deg: float
    length_m: float
    longitude_deg: float
    name: str
    rcs_dbsm: float
    route: TargetRoute
    sim_time_ns: int
    swerling: int
    top_m: float
    type: str
    valid_s: float
    velocity_east_m_s: float
    velocity_north_m_s: float
    velocity_up_m_s: float
    width_m: float
    def __init__(self, id: _Optional[int] = ..., name: _Optional[str] = ..., type: _Optional[str] = ..., latitude_deg: _Optional[float] = ..., longitude_deg: _Optional[float] = ..., height_m: _Optional[float] = ..., height_reference: _Optional[_Union[HeightReference, str]] = ..., geoid_undulation_m: _Optional[float] = ..., velocity_north_m_s: _Optional[float] = ..., velocity_east_m_s: _Optional[float] = ..., velocity_up_m_s: _Optional[float] = ..., acceleration_north_m_s2: _Optional[float] = ..., acceleration_east_m_s2: _Optional[float] = ..., acceleration_up_m_s2: _Optional[float] = ..., heading_deg: _Optional[float] = ..., heading_rate_deg_s: _Optional[float] = ..., rcs_dbsm: _Optional[float] = ..., swerling: _Optional[int] = ..., length_m: _Optional[float] = ..., width_m: _Optional[float] = ..., top_m: _Optional[float] = ..., sim_time_ns: _Optional[int] = ..., valid_s: _Optional[float] = ..., route: _Optional[_Union[TargetRoute, _Mapping]] = ..., age_s: _Optional[float] = ...) -> None: ...

class TargetBlock(_message.Message):
    __slots__ = ["azimuths", "frame_id", "record_bytes", "records"]
    AZIMUTHS_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    RECORDS_FIELD_NUMBER: _ClassVar[int]
    RECORD_BYTES_FIELD_NUMBER: _ClassVar[int]
    azimuths: AzimuthSpan
    frame_id: int
    record_bytes: int
    records: int
    def __init__(self, frame_id: _Optional[int] = ..., records: _Optional[int] = ..., record_bytes: _Optional[int] = ..., azimuths: _Optional[_Union[AzimuthSpan, _Mapping]] = ...) -> None: ...

class TargetList(_message.Message):
    __slots__ = ["controller", "expired", "late", "max_targets", "more", "request_id", "targets", "types", "version"]
    CONTROLLER_FIELD_NUMBER: _ClassVar[int]
    EXPIRED_FIELD_NUMBER: _ClassVar[int]
    LATE_FIELD_NUMBER: _ClassVar[int]
    MAX_TARGETS_FIELD_NUMBER: _ClassVar[int]
    MORE_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    TARGETS_FIELD_NUMBER: _ClassVar[int]
    TYPES_FIELD_NUMBER: _ClassVar[int]
    VERSION_FIELD_NUMBER: _ClassVar[int]
    controller: str
    expired: int
    late: int
    max_targets: int
    more: bool
    request_id: int
    targets: _containers.RepeatedCompositeFieldContainer[Target]
    types: _containers.RepeatedCompositeFieldContainer[TargetType]
    version: int
    def __init__(self, request_id: _Optional[int] = ..., targets: _Optional[_Iterable[_Union[Target, _Mapping]]] = ..., more: bool = ..., version: _Optional[int] = ..., controller: _Optional[str] = ..., max_targets: _Optional[int] = ..., expired: _Optional[int] = ..., late: _Optional[int] = ..., types: _Optional[_Iterable[_Union[TargetType, _Mapping]]] = ...) -> None: ...

class TargetRoute(_message.Message):
    __slots__ = ["height_m", "latitude_deg", "longitude_deg", "loops", "speed_m_s"]
    HEIGHT_M_FIELD_NUMBER: _ClassVar[int]
    LATITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    LONGITUDE_DEG_FIELD_NUMBER: _ClassVar[int]
    LOOPS_FIELD_NUMBER: _ClassVar[int]
    SPEED_M_S_FIELD_NUMBER: _ClassVar[int]
    height_m: _containers.RepeatedScalarFieldContainer[float]
    latitude_deg: _containers.RepeatedScalarFieldContainer[float]
    longitude_deg: _containers.RepeatedScalarFieldContainer[float]
    loops: bool
    speed_m_s: _containers.RepeatedScalarFieldContainer[float]
    def __init__(self, latitude_deg: _Optional[_Iterable[float]] = ..., longitude_deg: _Optional[_Iterable[float]] = ..., height_m: _Optional[_Iterable[float]] = ..., speed_m_s: _Optional[_Iterable[float]] = ..., loops: bool = ...) -> None: ...

class TargetType(_message.Message):
    __slots__ = ["dis", "length_m", "name", "rcs_dbsm", "swerling", "top_m", "width_m"]
    DIS_FIELD_NUMBER: _ClassVar[int]
    LENGTH_M_FIELD_NUMBER: _ClassVar[int]
    NAME_FIELD_NUMBER: _ClassVar[int]
    RCS_DBSM_FIELD_NUMBER: _ClassVar[int]
    SWERLING_FIELD_NUMBER: _ClassVar[int]
    TOP_M_FIELD_NUMBER: _ClassVar[int]
    WIDTH_M_FIELD_NUMBER: _ClassVar[int]
    dis: _containers.RepeatedScalarFieldContainer[str]
    length_m: float
    name: str
    rcs_dbsm: float
    swerling: int
    top_m: float
    width_m: float
    def __init__(self, name: _Optional[str] = ..., rcs_dbsm: _Optional[float] = ..., swerling: _Optional[int] = ..., length_m: _Optional[float] = ..., width_m: _Optional[float] = ..., top_m: _Optional[float] = ..., dis: _Optional[_Iterable[str]] = ...) -> None: ...

class Unsubscribe(_message.Message):
    __slots__ = ["radar", "request_id"]
    RADAR_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    radar: str
    request_id: int
    def __init__(self, request_id: _Optional[int] = ..., radar: _Optional[str] = ...) -> None: ...

class WedgeBlock(_message.Message):
    __slots__ = ["azimuth_step", "beam_ns", "boresight_rate_deg_s", "boresight_start_deg", "compression", "first_azimuth", "first_pulse", "first_range", "frame_id", "iq_encoding", "n_azimuth", "n_pulses", "n_range", "plain_bytes", "plane", "pose", "pose_received_ns", "pose_stale", "pulse_period_ns", "range_step", "render_start_ns", "scale", "send_ns", "settings_version", "wedge_index"]
    AZIMUTH_STEP_FIELD_NUMBER: _ClassVar[int]
    BEAM_NS_FIELD_NUMBER: _ClassVar[int]
    BORESIGHT_RATE_DEG_S_FIELD_NUMBER: _ClassVar[int]
    BORESIGHT_START_DEG_FIELD_NUMBER: _ClassVar[int]
    COMPRESSION_FIELD_NUMBER: _ClassVar[int]
    FIRST_AZIMUTH_FIELD_NUMBER: _ClassVar[int]
    FIRST_PULSE_FIELD_NUMBER: _ClassVar[int]
    FIRST_RANGE_FIELD_NUMBER: _ClassVar[int]
    FRAME_ID_FIELD_NUMBER: _ClassVar[int]
    IQ_ENCODING_FIELD_NUMBER: _ClassVar[int]
    N_AZIMUTH_FIELD_NUMBER: _ClassVar[int]
    N_PULSES_FIELD_NUMBER: _ClassVar[int]
    N_RANGE_FIELD_NUMBER: _ClassVar[int]
    PLAIN_BYTES_FIELD_NUMBER: _ClassVar[int]
    PLANE_FIELD_NUMBER: _ClassVar[int]
    POSE_FIELD_NUMBER: _ClassVar[int]
    POSE_RECEIVED_NS_FIELD_NUMBER: _ClassVar[int]
    POSE_STALE_FIELD_NUMBER: _ClassVar[int]
    PULSE_PERIOD_NS_FIELD_NUMBER: _ClassVar[int]
    RANGE_STEP_FIELD_NUMBER: _ClassVar[int]
    RENDER_START_NS_FIELD_NUMBER: _ClassVar[int]
    SCALE_FIELD_NUMBER: _ClassVar[int]
    SEND_NS_FIELD_NUMBER: _ClassVar[int]
    SETTINGS_VERSION_FIELD_NUMBER: _ClassVar[int]
    WEDGE_INDEX_FIELD_NUMBER: _ClassVar[int]
    azimuth_step: int
    beam_ns: int
    boresight_rate_deg_s: float
    boresight_start_deg: float
    compression: CompressionKind
    first_azimuth: int
    first_pulse: int
    first_range: int
    frame_id: int
    iq_encoding: IqEncodingKind
    n_azimuth: int
    n_pulses: int
    n_range: int
    plain_bytes: int
    plane: PlaneKind
    pose: Pose
    pose_received_ns: int
    pose_stale: bool
    pulse_period_ns: _containers.RepeatedScalarFieldContainer[float]
    range_step: int
    render_start_ns: int
    scale: float
    send_ns: int
    settings_version: int
    wedge_index: int
    def __init__(self, frame_id: _Optional[int] = ..., plane: _Optional[_Union[PlaneKind, str]] = ..., first_azimuth: _Optional[int] = ..., n_azimuth: _Optional[int] = ..., first_range: _Optional[int] = ..., n_range: _Optional[int] = ..., wedge_index: _Optional[int] = ..., pose: _Optional[_Union[Pose, _Mapping]] = ..., settings_version: _Optional[int] = ..., pose_received_ns: _Optional[int] = ..., render_start_ns: _Optional[int] = ..., send_ns: _Optional[int] = ..., iq_encoding: _Optional[_Union[IqEncodingKind, str]] = ..., scale: _Optional[float] = ..., compression: _Optional[_Union[CompressionKind, str]] = ..., plain_bytes: _Optional[int] = ..., azimuth_step: _Optional[int] = ..., range_step: _Optional[int] = ..., pose_stale: bool = ..., beam_ns: _Optional[int] = ..., first_pulse: _Optional[int] = ..., n_pulses: _Optional[int] = ..., pulse_period_ns: _Optional[_Iterable[float]] = ..., boresight_start_deg: _Optional[float] = ..., boresight_rate_deg_s: _Optional[float] = ...) -> None: ...

class Welcome(_message.Message):
    __slots__ = ["client_name", "encodings", "limits", "major", "minor", "radars", "request_id", "role", "scene_name", "server_name", "server_version", "truth"]
    CLIENT_NAME_FIELD_NUMBER: _ClassVar[int]
    ENCODINGS_FIELD_NUMBER: _ClassVar[int]
    LIMITS_FIELD_NUMBER: _ClassVar[int]
    MAJOR_FIELD_NUMBER: _ClassVar[int]
    MINOR_FIELD_NUMBER: _ClassVar[int]
    RADARS_FIELD_NUMBER: _ClassVar[int]
    REQUEST_ID_FIELD_NUMBER: _ClassVar[int]
    ROLE_FIELD_NUMBER: _ClassVar[int]
    SCENE_NAME_FIELD_NUMBER: _ClassVar[int]
    SERVER_NAME_FIELD_NUMBER: _ClassVar[int]
    SERVER_VERSION_FIELD_NUMBER: _ClassVar[int]
    TRUTH_FIELD_NUMBER: _ClassVar[int]
    client_name: str
    encodings: _containers.RepeatedScalarFieldContainer[str]
    limits: Limits
    major: int
    minor: int
    radars: _containers.RepeatedScalarFieldContainer[str]
    request_id: int
    role: str
    scene_name: str
    server_name: str
    server_version: str
    truth: bool
    def __init__(self, request_id: _Optional[int] = ..., major: _Optional[int] = ..., minor: _Optional[int] = ..., server_name: _Optional[str] = ..., server_version: _Optional[str] = ..., scene_name: _Optional[str] = ..., radars: _Optional[_Iterable[str]] = ..., encodings: _Optional[_Iterable[str]] = ..., limits: _Optional[_Union[Limits, _Mapping]] = ..., client_name: _Optional[str] = ..., role: _Optional[str] = ..., truth: bool = ...) -> None: ...

class FrustumKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class PlateKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class SpeckleKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class BeamPattern(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class ElevationPattern(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class PulseKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class PulseWindow(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class ScanMode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class RadarMode(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class DopplerWindow(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class Polarisation(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class HeightReference(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class PlaneKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class IqEncodingKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class CompressionKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class ClaimKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()

class EventKind(int, metaclass=_enum_type_wrapper.EnumTypeWrapper):
    __slots__ = ()
