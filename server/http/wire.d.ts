// The messages of proto/obliq.proto in protobuf's JSON: enumerators by name, 64 bits as text, an absent field has its default.
// Written by server/http/make_types.py: do not edit.

export type Int64 = string;
export type Real = number | "Infinity" | "-Infinity" | "NaN";

export type FrustumKind = "OBLIQUE" | "SYMMETRIC" | "POLAR" | "SWEEP";
export type PlateKind = "SPREAD_PLATES" | "NEAREST_PLATES";
export type SpeckleKind = "GROUND_SPECKLE" | "GEOMETRIC_SPECKLE" | "NONE_SPECKLE" | "INDEPENDENT_SPECKLE" | "AUTO_SPECKLE";
export type BeamPattern = "OFF_BEAM" | "GAUSSIAN_BEAM" | "UNIFORM_BEAM" | "COSINE_BEAM" | "TAYLOR_BEAM" | "FILE_BEAM";
export type ElevationPattern = "OFF_ELEVATION" | "GAUSSIAN_ELEVATION" | "COSECANT_ELEVATION" | "FILE_ELEVATION";
export type PulseKind = "OFF_PULSE" | "RECTANGULAR_PULSE" | "COMPRESSED_PULSE";
export type PulseWindow = "NONE_WINDOW" | "HAMMING_WINDOW" | "HANN_WINDOW" | "TAYLOR_WINDOW";
export type ScanMode = "FRAME_SCAN" | "SECTOR_SCAN" | "CIRCULAR_SCAN";
export type RadarMode = "MAP_MODE" | "MTI_MODE" | "DBS_MODE" | "SAR_MODE" | "PULSES_MODE";
export type DopplerWindow =
  | "NONE_DOPPLER_WINDOW"
  | "HAMMING_DOPPLER_WINDOW"
  | "HANN_DOPPLER_WINDOW"
  | "TAYLOR_DOPPLER_WINDOW"
  | "BLACKMAN_HARRIS_DOPPLER_WINDOW";
export type Polarisation = "HORIZONTAL" | "VERTICAL";
export type HeightReference = "DATUM" | "GROUND" | "ELLIPSOID";
export type PlaneKind = "IQ" | "POWER" | "COUNT" | "STATE" | "VIDEO" | "PULSES" | "MATERIAL" | "BUILDING" | "HEIGHT" | "RETURNS" | "TARGET";
export type IqEncodingKind = "CF32_LE" | "CI16_LE";
export type CompressionKind = "UNCOMPRESSED" | "ZSTD";
/** What of a radar one client at a time may hold. */
export type ClaimKind = "POSE_CLAIM" | "SETTINGS_CLAIM" | "TARGETS_CLAIM";
/** What an event is about. A reader skips the numbers that it does not know. */
export type EventKind =
  | "NO_EVENT"
  | "CLAIM_EVENT"
  | "RELEASE_EVENT"
  | "TAKE_OVER_EVENT"
  | "SETTINGS_EVENT"
  | "AIM_EVENT"
  | "SWITCH_EVENT"
  | "RESET_EVENT"
  | "LOAD_EVENT"
  | "FREEZE_EVENT"
  | "BOOKMARK_EVENT"
  | "TARGETS_EVENT";

/** Elevations of the boresight, up positive: one a pass of a scan, in turn; none: Pose.tilt_deg. */
export interface ScanBars {
  tilt_deg?: Real[];
}

/** Intervals between pulses over 1 / prf_hz, one after the other, round and round; none: all alike. */
export interface PulseStagger {
  ratio?: Real[];
}

/** Every field is optional: an absent one keeps its value (SetSettings) or takes its default (RenderOnce). */
export interface RadarSettings {
  frequency_ghz?: Real;
  sector_deg?: Real;
  r_min_m?: Real;
  r_max_m?: Real;
  power_w?: Real;
  gain_db?: Real;
  range_normalisation?: boolean;
  speckle?: SpeckleKind;
  speckle_seed?: Int64;
  frustum?: FrustumKind;
  pixel_columns?: number;
  pixel_rows?: number;
  azimuth_bins?: number;
  range_bins?: number;
  /** of the symmetric, oblique and polar frusta */
  plates?: PlateKind;
  /** How a live radar's antenna sweeps its sector; RenderOnce takes no notice. */
  scan_mode?: ScanMode;
  scan_rate_deg_s?: Real;
  scan_dwell_bins?: number;
  scan_bars?: ScanBars;
  /** of the sweep; 0: exact planes at buildings */
  sub_columns?: number;
  /** The antenna's pattern, one way. Elevations: Pose.tilt_deg. */
  beam_pattern?: BeamPattern;
  beam_width_deg?: Real;
  beam_sidelobe_db?: Real;
  beam_nbar?: number;
  /** 0: chosen by the pattern */
  beam_extent_deg?: Real;
  beam_elevation?: ElevationPattern;
  beam_elevation_width_deg?: Real;
  beam_cosecant_to_deg?: Real;
  pulse_kind?: PulseKind;
  pulse_length_us?: Real;
  /** 0: that which a range bin resolves */
  pulse_bandwidth_mhz?: Real;
  pulse_window?: PulseWindow;
  pulse_sidelobe_db?: Real;
  pulse_nbar?: number;
  pulse_extent_bins?: number;
  pulse_eclipse?: boolean;
  /** The receiver. */
  noise?: boolean;
  noise_figure_db?: Real;
  antenna_temperature_k?: Real;
  /** of the echo; the noise does not feel it */
  loss_db?: Real;
  noise_seed?: Int64;
  /** the counter of a frame of RenderOnce; a live radar counts its frames */
  noise_frame?: Int64;
  receiver_gain_db?: Real;
  /** 0: no sensitivity time control */
  stc_range_m?: Real;
  stc_power?: Real;
  stc_db?: Real;
  /** 0: no converter */
  adc_bits?: number;
  full_scale_dbm?: Real;
  /** The video. */
  video_looks?: number;
  /** absent, with a video_floor_db: false */
  video_floor_auto?: boolean;
  video_floor_db?: Real;
  video_span_db?: Real;
  /** The atmosphere. */
  rain_mm_h?: Real;
  rain_top_m?: Real;
  gas?: boolean;
  polarisation?: Polarisation;
  /** Of the sweep: above 0, so many planes in each azimuth bin. A request that has pixel_columns sets it to 0. */
  planes_per_bin?: number;
  /** false: the beam rolls and pitches with the platform (Pose) */
  beam_stabilised?: boolean;
  /** Doppler: what the bins are made of. */
  mode?: RadarMode;
  prf_hz?: Real;
  doppler_pulses?: number;
  doppler_window?: DopplerWindow;
  /** delays of the moving target indicator */
  canceller?: number;
  /** its notch follows the ground in the beam's middle */
  clutter_lock?: boolean;
  /** of the atmosphere */
  wind_m_s?: Real;
  /** across range, of SAR_MODE */
  resolution_m?: Real;
  /** of PULSES_MODE */
  pulse_stagger?: PulseStagger;
  /** The sea. */
  sea_state?: Real;
  /** of the texture of a small cell; 0: none */
  sea_shape?: Real;
  /** clockwise from true north */
  wind_from_deg?: Real;
  /** from the wind; absent, with a sea_state: false */
  sea_state_auto?: boolean;
  /** of the video: what a bin has above its mean over this time; 0: no fast time constant */
  ftc_us?: Real;
}

export interface Pose {
  latitude_deg?: Real;
  longitude_deg?: Real;
  height_m?: Real;
  height_reference?: HeightReference;
  geoid_undulation_m?: Real;
  bearing_deg?: Real;
  sim_time_ns?: Int64;
  pose_id?: Int64;
  /** after its arrival; 0: for ever */
  valid_s?: Real;
  /** elevation of the boresight, up positive; alone it ends tilt_auto */
  tilt_deg?: Real;
  /** instead: towards level ground in the middle of the swath */
  tilt_auto?: boolean;
  /** Metres a second over the ground along the antenna's own north, east and up; one that is absent beside another is 0. Without all three: from the poses by their own sim times. PROTOCOL.md, "Velocity and attitude". */
  velocity_north_m_s?: Real;
  velocity_east_m_s?: Real;
  velocity_up_m_s?: Real;
  /** of the platform, right side down positive */
  roll_deg?: Real;
  /** of the platform, nose up positive */
  pitch_deg?: Real;
  /** of the platform's nose; alone it turns the antenna too */
  heading_deg?: Real;
  /** the clock was set: poses before this one are forgotten. Of this SetPose alone */
  new_time_line?: boolean;
  /** seconds of sim time in a second, from this pose on */
  time_rate?: Real;
}

export interface Material {
  name?: string;
  model?: string;
  gamma?: Real;
  reflectivity?: Real;
  rms_slope?: Real;
  plate_tau?: Real;
  plate_exponent?: Real;
}

/** All that is needed to interpret, place and write a frame, known before its first wedge is rendered. */
export interface FrameDescriptor {
  radar?: string;
  frame_id?: Int64;
  settings_version?: Int64;
  settings?: RadarSettings;
  pose?: Pose;
  /** World frame: tangent plane at the scene origin, x east, y up, z north; effective-earth factor (infinity = flat ground). */
  origin_latitude_deg?: Real;
  origin_longitude_deg?: Real;
  radius_factor?: Real;
  antenna_x_m?: Real;
  antenna_y_m?: Real;
  antenna_z_m?: Real;
  /** Bearings are clockwise from the antenna's true north, which points along this angle, clockwise from +z (north at the origin). PROTOCOL.md, "Where a bin lies". */
  north_rad?: Real;
  wavelength_m?: Real;
  /** left edge of azimuth bin 0, true bearing */
  azimuth_start_deg?: Real;
  azimuth_width_deg?: Real;
  /** near edge of range bin 0, slant range */
  range_start_m?: Real;
  range_spacing_m?: Real;
  /** -1: phase = -4 pi r / lambda */
  phase_sign?: number;
  /** of I&Q: "sqrt(W)", with range_normalisation "sqrt(W) m^2" */
  unit?: string;
  /** "clockwise from the antenna's true north" */
  azimuth_reference?: string;
  /** Terrain and roofs in sector and range. */
  bottom_y_m?: Real;
  top_y_m?: Real;
  /** median ground height above the datum, for slant to ground range */
  map_reference_height_m?: Real;
  azimuth_error_bound_rad?: Real;
  materials?: Material[];
  scene_name?: string;
  cell_m?: Real;
  wedge_azimuth_bins?: number;
  warnings?: string[];
  buildings_in_scene?: number;
  /** of the power plane: "W", with range_normalisation "W m^4" */
  power_unit?: string;
  source_error?: SourceError;
  /** The bins that were asked for, when they are not all; everything above describes the whole frame. */
  window?: BinWindow;
  /** the newest pose's validity has run out */
  pose_stale?: boolean;
  ground?: LoadedGround;
  /** mean of the noise before gain and STC; 0: none. CNR = power / noise_power_w */
  noise_power_w?: Real;
  /** what the noise repeats with: the same in settings.noise_frame gives the same frame */
  noise_counter?: Int64;
  /** of I and Q, one count of the converter; 0: none. A block as CI16_LE has it as its scale */
  adc_step?: Real;
  /** of level 1 of the video, re power_unit; settings.video_span_db above it is the highest */
  video_floor_db?: Real;
  /** 32 hexadecimal digits of what the world is made from: contents of its sources, keys that shape ground, prisms, surfaces, materials; not what is loaded of it. Empty: the server does not know it. */
  scene_hash?: string;
  /** of the server, as Welcome has it in server_version */
  build?: string;
  /** of the world's targets when the frame was begun */
  targets_version?: Int64;
  /** in the frame's world, seen or not */
  targets?: number;
}

/** What the ground and the buildings of a frame were made of. */
export interface LoadedGround {
  /** none: made-up ground */
  elevation?: ElevationModel[];
  /** above the datum, of all that is loaded */
  lowest_m?: Real;
  highest_m?: Real;
  /** a source each */
  building_heights?: BuildingHeights[];
  /** found in the elevation models (terrain.sea) */
  water_km2?: Real;
}

export interface ElevationModel {
  /** without its folder */
  file?: string;
  /** of its heights */
  unit?: string;
  /** neither the file nor the scene names it */
  unit_assumed?: boolean;
}

/** The heights of buildings that one source's field gave. */
export interface BuildingHeights {
  /** without its folder */
  file?: string;
  field?: string;
  /** of bare numbers: "m" or "ft" */
  unit?: string;
  found?: Int64;
  least_m?: Real;
  median_m?: Real;
  most_m?: Real;
  /** buildings that got default_m */
  by_default?: Int64;
  default_m?: Real;
}

/** How far the grid's surface lies from the elevation models' own posts, in world y. All 0: not compared. */
export interface SourceError {
  /** compared */
  posts?: Int64;
  median_m?: Real;
  /** 95 % of the posts are no further off */
  p95_m?: Real;
  rms_m?: Real;
  greatest_m?: Real;
}

/** Known when the last wedge is done. */
export interface FrameSummary {
  frame_id?: Int64;
  rays?: Int64;
  hits?: Int64;
  samples?: Int64;
  /** leaked rays without an answer */
  rejected?: Int64;
  coverage?: Real;
  buildings_seen?: number;
  /** leaked rays answered anew, in double precision */
  repaired?: Int64;
  /** that hold visible surface, sampled or not; 0: the state plane was not asked for */
  lit_bins?: Int64;
  /** of those */
  unsampled_bins?: Int64;
  /** what is wrong with this frame, and what would mend it */
  warnings?: string[];
}

/** Bins of a frame: n_azimuth from first_azimuth on, of those every azimuth_step-th, the first included; ranges alike. */
export interface BinWindow {
  first_azimuth?: number;
  /** spanned; 0: all that follow */
  n_azimuth?: number;
  /** 0 is 1 */
  azimuth_step?: number;
  first_range?: number;
  n_range?: number;
  range_step?: number;
}

/** First message of a client. */
export interface Hello {
  request_id?: Int64;
  major?: number;
  minor?: number;
  /** shown to others when this client holds control */
  client_name?: string;
  /** where the server wants one */
  token?: string;
}

/** Answer to Hello. */
export interface Welcome {
  request_id?: Int64;
  major?: number;
  minor?: number;
  server_name?: string;
  server_version?: string;
  scene_name?: string;
  radars?: string[];
  /** of plane data: "cf32_le", "ci16_le", "zstd" */
  encodings?: string[];
  limits?: Limits;
  /** as the server will show it */
  client_name?: string;
  /** "viewer", "controller" or "admin" */
  role?: string;
  /** this client may be told where targets are (server.truth_role) */
  truth?: boolean;
}

export interface Limits {
  max_request_bytes?: number;
  max_plane_bytes?: number;
  max_clients?: number;
  /** RenderOnce requests of one client that are not finished */
  max_renders_queued?: number;
  /** of one client */
  max_subscriptions?: number;
  max_rate_hz?: Real;
  max_clients_per_address?: number;
  /** of one frame */
  max_pixels?: Int64;
  /** of one frame */
  max_bins?: Int64;
  /** pixels and bins of all clients' unfinished RenderOnce requests */
  max_work_queued?: Int64;
  /** of the server; 0: no limit */
  max_memory_mb?: Int64;
  /** the server is never silent for longer */
  heartbeat_s?: Real;
  /** the client must not be silent for longer; 0: it may */
  idle_timeout_s?: Real;
  /** of one QueryGround; 0: the server answers none */
  max_query_points?: number;
  /** in the world, and in one RenderOnce */
  max_targets?: number;
}

export interface Ack {
  request_id?: Int64;
  /** SetSettings, SetPose: of the radar, after the change */
  settings_version?: Int64;
  /** of what was accepted all the same: a pose where no file has ground, say */
  warnings?: string[];
  /** SetPose: part of the disc within r_max for which the files have ground */
  coverage?: Real;
}

export interface FieldFault {
  /** a parameter's key, as in PARAMETERS.md, or a field of the request */
  field?: string;
  found?: string;
  allowed?: string;
}

export interface Error {
  /** 0: not the answer to a request */
  request_id?: Int64;
  /** stable; PROTOCOL.md lists them */
  number?: number;
  text?: string;
  fields?: FieldFault[];
  radar?: string;
}

/** Says that its sender is there. Either side may send one after Welcome. */
export interface Heartbeat {
  /** the answer repeats it */
  request_id?: Int64;
  /** the receiver sends one back that wants none */
  answer_wanted?: boolean;
}

export interface ListRadars {
  request_id?: Int64;
}

export interface RadarList {
  request_id?: Int64;
  radars?: string[];
  /** that radars ride on */
  platforms?: string[];
}

export interface GetRadar {
  request_id?: Int64;
  /** or a platform */
  radar?: string;
}

export interface RadarInfo {
  request_id?: Int64;
  radar?: string;
  /** complete */
  settings?: RadarSettings;
  /** complete */
  pose?: Pose;
  settings_version?: Int64;
  /** that holds the pose; empty: no client */
  controller?: string;
  /** you hold the pose */
  controlled_by_you?: boolean;
  subscribers?: number;
  /** 0: no client watches */
  rate_hz?: Real;
  /** why no frame can be rendered at present; empty: none */
  fault?: string;
  pose_stale?: boolean;
  /** that arrived with a sim time before the newest, since start */
  late_poses?: Int64;
  /** by the operator: nothing is rendered */
  transmit_off?: boolean;
  /** by the operator or a watchdog: frames keep an older pose and older settings */
  frozen?: boolean;
  /** the operator's; 0: none */
  rate_limit_hz?: Real;
  /** that holds the settings; empty: no client */
  settings_controller?: string;
  /** what you hold */
  claimed_by_you?: ClaimKind[];
  /** SetExercise: no frame, until it ends */
  exercise_frozen?: boolean;
  /** that the radar rides on; empty: none */
  platform?: string;
  /** of a platform in a radar's place: the radars on it; settings are absent */
  riders?: string[];
  /** the limit that the antenna stands at, in words; empty: it looks as asked */
  gimbal?: string;
}

export interface ClaimControl {
  request_id?: Int64;
  radar?: string;
  /** from its holder, which is told; for an admin */
  force?: boolean;
  /** all or none are given; none named: pose and settings */
  kinds?: ClaimKind[];
}

export interface ReleaseControl {
  request_id?: Int64;
  radar?: string;
  /** none named: all that this client holds */
  kinds?: ClaimKind[];
}

export interface SetSettings {
  request_id?: Int64;
  radar?: string;
  /** absent fields keep their value */
  settings?: RadarSettings;
}

export interface SetPose {
  request_id?: Int64;
  radar?: string;
  /** absent fields keep their value */
  pose?: Pose;
}

/** Switches a radar as the operator's console does (server/modbus). An absent field keeps its state. */
export interface SetState {
  request_id?: Int64;
  radar?: string;
  /** false: nothing is rendered */
  transmit?: boolean;
  /** true: frames keep the pose and the settings of this moment */
  freeze?: boolean;
}

export interface Subscribe {
  request_id?: Int64;
  radar?: string;
  /** 0.001 to Limits.max_rate_hz */
  rate_hz?: Real;
  /** none: iq, power, count and state */
  planes?: PlaneKind[];
  iq_encoding?: IqEncodingKind;
  /** blocks that do not become smaller come uncompressed all the same */
  compression?: CompressionKind;
  /** absent: the whole frame */
  window?: BinWindow;
  /** of plane VIDEO: 8 or 16; 0 is 8 */
  video_bits?: number;
  /** no frame is left out: the radar waits. Needs the role controller */
  lossless?: boolean;
  /** TargetBlocks too. Needs the server's truth role */
  truth?: boolean;
}

export interface Unsubscribe {
  request_id?: Int64;
  radar?: string;
}

/** Renders one frame for this client alone; no live radar is touched. The name is only echoed. */
export interface RenderOnce {
  request_id?: Int64;
  radar?: string;
  /** absent fields take their default, or with as_live the radar's value */
  settings?: RadarSettings;
  /** latitude, longitude and height must be given, but for as_live */
  pose?: Pose;
  /** none: iq, power, count and state */
  planes?: PlaneKind[];
  /** As in Subscribe. */
  iq_encoding?: IqEncodingKind;
  compression?: CompressionKind;
  window?: BinWindow;
  video_bits?: number;
  /** what settings and pose do not have is as the live radar `radar` has it now */
  as_live?: boolean;
  /** Targets of this frame alone, each with an id of its own; fields that are absent take their default or their type's value. One without sim_time_ns is where it says. */
  targets?: Target[];
  /** those of the world as well, but for ids that stand above */
  live_targets?: boolean;
  /** TargetBlocks too. Of live targets: needs the server's truth role */
  truth?: boolean;
}

/** What is at up to Limits.max_query_points places, and whether an antenna sees points there. */
export interface QueryGround {
  request_id?: Int64;
  /** whose antenna looks, from where it is now; empty: `antenna`, or none */
  radar?: string;
  /** in place of a live radar's; latitude, longitude and height must be given */
  antenna?: Pose;
  /** The places [n]: latitude and longitude, or bearing and slant range from the antenna to the ground. */
  latitude_deg?: Real[];
  longitude_deg?: Real[];
  /** clockwise from the antenna's true north */
  bearing_deg?: Real[];
  range_m?: Real[];
  /** Of the points that are seen or not: [n], or one for all; none: on the ground. */
  height_m?: Real[];
  height_reference?: HeightReference;
  /** with ELLIPSOID */
  geoid_undulation_m?: Real;
}

/** Answer to QueryGround: `points` records of `record_bytes` follow as plane data. PROTOCOL.md, "Ground queries". */
export interface GroundAnswer {
  request_id?: Int64;
  points?: number;
  record_bytes?: number;
  /** names; records have their numbers, from 0 */
  materials?: string[];
  /** that looked; absent: none */
  antenna?: Pose;
}

/** How a recording is played, for all that watch it: of `obliq replay --serve` alone. An absent field changes nothing. */
export interface SetReplay {
  request_id?: Int64;
  paused?: boolean;
  /** recorded seconds in a second: 0.01 to 1000000, or infinity: without waiting */
  speed?: Real;
  /** to the frame of that time, from the recording's beginning */
  seek_s?: Real;
  /** to the time of the event of that number */
  seek_bookmark?: Int64;
  /** to the frame of that time by the poses' own clock (Pose.sim_time_ns) */
  seek_sim_time_ns?: Int64;
}

/** Where a replay is: sent behind Welcome, and whenever more has changed than the time. Answers no request. */
export interface ReplayState {
  radar?: string;
  /** of the recording's first frame */
  start_utc_ns?: Int64;
  /** from there to the end of its last */
  duration_s?: Real;
  /** from there, when this was sent; while `running` it grows by `speed` a second */
  position_s?: Real;
  speed?: Real;
  paused?: boolean;
  /** not paused, not at the end, and some client watches */
  running?: boolean;
  loop?: boolean;
  /** the last frame has been shown; a seek goes back */
  ended?: boolean;
  /** of the newest frame's pose; absent: it has none */
  sim_time_ns?: Int64;
  /** so far; after each the frame before the place comes whole, then that of the place */
  seeks?: Int64;
}

/** Where a target goes from the place where it is: to each point in turn, along the ellipsoid. */
export interface TargetRoute {
  /** of the points, [n]; none: it follows no route any more */
  latitude_deg?: Real[];
  /** [n] */
  longitude_deg?: Real[];
  /** over the target's reference; [n], or none: its own */
  height_m?: Real[];
  /** on the way to each, [n], or one for all */
  speed_m_s?: Real[];
  /** from the last point back to its first place, and so on */
  loops?: boolean;
}

/** In SetTargets an absent field keeps its value; of a new id it takes its type's, or its default. */
export interface Target {
  /** from 1 */
  id?: Int64;
  name?: string;
  /** of the scene's [target_types.NAME]; empty: none */
  type?: string;
  latitude_deg?: Real;
  longitude_deg?: Real;
  /** of its foot */
  height_m?: Real;
  height_reference?: HeightReference;
  geoid_undulation_m?: Real;
  /** Along its own north, east and up. Of a target without a route. */
  velocity_north_m_s?: Real;
  velocity_east_m_s?: Real;
  velocity_up_m_s?: Real;
  acceleration_north_m_s2?: Real;
  acceleration_east_m_s2?: Real;
  acceleration_up_m_s2?: Real;
  /** absent of a new one: along its course */
  heading_deg?: Real;
  heading_rate_deg_s?: Real;
  rcs_dbsm?: Real;
  swerling?: number;
  length_m?: Real;
  width_m?: Real;
  top_m?: Real;
  /** of its place and motion, in the clock of the poses; absent: of its arrival */
  sim_time_ns?: Int64;
  /** after its arrival; 0: for ever */
  valid_s?: Real;
  route?: TargetRoute;
  /** its place and motion were so this long ago. Not beside sim_time_ns */
  age_s?: Real;
}

/** Clears, then takes those away that are gone, then sets the others: all of it at once for all frames, or nothing. */
export interface SetTargets {
  request_id?: Int64;
  targets?: Target[];
  gone?: Int64[];
  clear?: boolean;
  /** kept until a request of this client without `more` comes, then all of it is done at once */
  more?: boolean;
}

export interface GetTargets {
  request_id?: Int64;
  /** only those with greater ids */
  after?: Int64;
}

/** Answer to GetTargets, rising by id. */
export interface TargetList {
  request_id?: Int64;
  /** as they were set, complete; those without a sim time say their age_s */
  targets?: Target[];
  /** ask again, behind the last of these */
  more?: boolean;
  /** of the world's targets: one more with every change */
  version?: Int64;
  /** that holds the claim of targets; empty: no client */
  controller?: string;
  max_targets?: number;
  /** that went because their valid_s was over, since start */
  expired?: Int64;
  /** updates with a sim time before the newest of their target, since start */
  late?: Int64;
  /** of the scene; with the first page */
  types?: TargetType[];
}

/** What a new target of the type takes. */
export interface TargetType {
  name?: string;
  rcs_dbsm?: Real;
  swerling?: number;
  length_m?: Real;
  width_m?: Real;
  top_m?: Real;
  /** Entities of DIS that are such targets: kind.domain.country.category.subcategory.specific.extra. "*" stands for any, and so does what is left out at the end. */
  dis?: string[];
}

export interface GetStatus {
  request_id?: Int64;
}

export interface RadarStatus {
  radar?: string;
  /** as in RadarInfo */
  controller?: string;
  subscribers?: number;
  rate_hz?: Real;
  /** rendered */
  frames?: Int64;
  /** wall time of the newest frame */
  last_render_s?: Real;
  settings_version?: Int64;
  fault?: string;
  /** of which something waits for a client, or that is being rendered */
  live_frames?: number;
  /** in memory, of all its blocks */
  live_bytes?: Int64;
  /** not rendered in time because live_frames were at their limit */
  frames_skipped?: Int64;
  /** not rendered because there was no time for all that was asked for */
  frames_shed?: Int64;
  pose_stale?: boolean;
  late_poses?: Int64;
  /** of a scanning antenna, since start */
  dwells_missed?: Int64;
  /** of the newest frame's sector, 0 to 1: over known ground; absent: no frame */
  coverage?: Real;
  /** why it is less than 1; empty: it is not, or not known */
  coverage_reason?: string;
  /** as in RadarInfo */
  transmit_off?: boolean;
  frozen?: boolean;
  rate_limit_hz?: Real;
  settings_controller?: string;
  platform?: string;
  gimbal?: string;
}

export interface Status {
  request_id?: Int64;
  server_name?: string;
  server_version?: string;
  uptime_s?: Real;
  clients?: number;
  /** whole frames that clients were too slow for, since start */
  frames_dropped?: Int64;
  bytes_sent?: Int64;
  renders_queued?: number;
  radars?: RadarStatus[];
  /** parts of the terrain that were loaded in flight, and reloads, since start */
  windows_loaded?: Int64;
  /** one is being loaded */
  window_loading?: boolean;
  /** that could not be loaded */
  window_failures?: Int64;
  /** why ground is missing at present; empty: all is well */
  window_error?: string;
  /** the newest failure, however long ago */
  window_failure?: string;
  /** since the newest failure was over; 0: it is not, or there was none */
  window_well_s?: Real;
  /** all radars stand still */
  exercise_frozen?: boolean;
  /** in the world */
  targets?: number;
  max_targets?: number;
  /** that holds their claim; empty: no client */
  targets_controller?: string;
  /** as in TargetList */
  targets_expired?: Int64;
  targets_late?: Int64;
}

/** Settings, pose and switches as the scene file has them. */
export interface ResetExercise {
  request_id?: Int64;
  /** empty: all */
  radar?: string;
}

/** Stops all radars: clock, antenna and noise stand, and no frame is begun, but one for each who comes to watch. */
export interface SetExercise {
  request_id?: Int64;
  frozen?: boolean;
}

export interface GetExercise {
  request_id?: Int64;
  /** of more than one message holds; GetTargets has them page by page */
  without_targets?: boolean;
}

export interface RadarState {
  radar?: string;
  settings?: RadarSettings;
  pose?: Pose;
  transmit_off?: boolean;
  frozen?: boolean;
  rate_limit_hz?: Real;
}

/** Answer to GetExercise, and what LoadExercise puts in place. */
export interface ExerciseState {
  request_id?: Int64;
  /** of these fields: 1 */
  version?: number;
  /** of FrameDescriptor */
  scene_hash?: string;
  scene_name?: string;
  build?: string;
  radars?: RadarState[];
  platforms?: PlatformState[];
  /** only for a client with the truth role */
  targets?: Target[];
  /** `targets` are all there are; else nothing is said of them */
  with_targets?: boolean;
}

/** Where a platform is; its radars' poses follow from it. */
export interface PlatformState {
  platform?: string;
  pose?: Pose;
}

export interface LoadExercise {
  request_id?: Int64;
  state?: ExerciseState;
}

/** Who changed what of an exercise, and when. */
export interface ExerciseEvent {
  /** from 1, since the server's start */
  number?: Int64;
  /** of a bookmark in a replay: of its place */
  utc_ns?: Int64;
  kind?: EventKind;
  /** the client's name, or "the operator's console" */
  by?: string;
  /** empty: all */
  radar?: string;
  /** of the radar's newest pose; absent: it has none */
  sim_time_ns?: Int64;
  /** CLAIM, RELEASE, TAKE_OVER */
  claims?: ClaimKind[];
  /** TAKE_OVER: the client that held them */
  taken_from?: string;
  /** SETTINGS: what has changed */
  settings?: RadarSettings;
  /** AIM: as the client asked for it */
  pose?: Pose;
  /** SWITCH, likewise */
  transmit?: boolean;
  /** SWITCH, FREEZE */
  freeze?: boolean;
  rate_limit_hz?: Real;
  /** RESET: of what was reset, as it is then; LOAD: of all */
  state?: ExerciseState;
  /** BOOKMARK */
  text?: string;
  /** TARGETS: so many new ones */
  targets_come?: number;
  targets_gone?: number;
}

export interface GetEvents {
  request_id?: Int64;
  /** only those with greater numbers */
  after?: Int64;
  /** later ones come by themselves, from an answer without `more` on */
  follow?: boolean;
  /** such an answer says how the exercise stands behind its events */
  with_state?: boolean;
}

/** Answer to GetEvents; and an event when it happens, with request_id 0, to clients that follow. */
export interface ExerciseEvents {
  request_id?: Int64;
  events?: ExerciseEvent[];
  /** ask again, behind the last of these */
  more?: boolean;
  /** older ones that the server no longer has */
  lost?: Int64;
  state?: ExerciseState;
  /** of all radars; with `state` */
  frozen?: boolean;
}

/** An event with a text, for all stations. In a replay: at the place where it is. */
export interface AddBookmark {
  request_id?: Int64;
  text?: string;
}

/** One sweep of a scanning antenna from one end of its sector to the other, or once round. */
export interface ScanPass {
  mode?: ScanMode;
  /** azimuth bins come in rising order; else in falling order */
  clockwise?: boolean;
  rate_deg_s?: Real;
  /** azimuth bins that share a pose */
  dwell_bins?: number;
  /** when the beam was or will be at the pass's first edge; the server's monotonic clock */
  begin_ns?: Int64;
}

export interface AzimuthSpan {
  first_azimuth?: number;
  n_azimuth?: number;
}

export interface FrameBegin {
  frame_id?: Int64;
  /** of the RenderOnce; 0 for a subscription */
  request_id?: Int64;
  frame?: FrameDescriptor;
  /** that overlap the window */
  wedges?: number;
  /** due to this client since its last FrameBegin, and neither begun nor sent */
  frames_skipped?: Int64;
  /** a pass of a scanning antenna; absent: all of the sector at once */
  scan?: ScanPass;
}

/** Protobuf part of a data block; the plane's values of one rectangle follow it. */
export interface WedgeBlock {
  frame_id?: Int64;
  plane?: PlaneKind;
  first_azimuth?: number;
  n_azimuth?: number;
  first_range?: number;
  n_range?: number;
  wedge_index?: number;
  /** that the wedge was rendered for, with its pose_id and sim_time_ns */
  pose?: Pose;
  settings_version?: Int64;
  /** The server's monotonic clock; only differences mean anything. */
  pose_received_ns?: Int64;
  render_start_ns?: Int64;
  /** when the block was handed to the clients' queues */
  send_ns?: Int64;
  /** How the values follow. n_azimuth and n_range count what is sent; value k of a row is range bin first_range + k range_step of the whole frame, and azimuths alike. A step of 0 is 1. */
  iq_encoding?: IqEncodingKind;
  /** CI16_LE: value = integer x scale */
  scale?: Real;
  compression?: CompressionKind;
  /** ZSTD: of the values uncompressed */
  plain_bytes?: number;
  azimuth_step?: number;
  range_step?: number;
  pose_stale?: boolean;
  /** when the beam stood in the middle of this dwell; 0: not scanning */
  beam_ns?: Int64;
  /** Of a PULSES block: values are [n_pulses][n_range], of one train along all of its azimuths. PROTOCOL.md, "Pulse trains". */
  first_pulse?: number;
  n_pulses?: number;
  /** intervals between pulses, round and round */
  pulse_period_ns?: Real[];
  /** at pulse 0, clockwise from the antenna's true north */
  boresight_start_deg?: Real;
  boresight_rate_deg_s?: Real;
}

/** Where targets are in the frame, to clients that asked for truth: before FrameEnd, of a pass behind each dwell. `records` records of `record_bytes` follow as plane data. PROTOCOL.md, "Truth". */
export interface TargetBlock {
  frame_id?: Int64;
  records?: number;
  record_bytes?: number;
  /** of the dwell; of a whole frame all */
  azimuths?: AzimuthSpan;
}

export interface FrameEnd {
  frame_id?: Int64;
  summary?: FrameSummary;
  /** wall time from plan to last wedge, the turns of other radars in between included */
  render_s?: Real;
  /** how long after its date the frame was begun; 0 for a RenderOnce and for passes */
  waited_s?: Real;
  /** of a pass: dwells that could not be rendered when the beam was there */
  missed?: AzimuthSpan[];
}

export interface FrameAbort {
  frame_id?: Int64;
  /** of the RenderOnce; 0 for a subscription */
  request_id?: Int64;
  reason?: string;
}

/** By name. */
export interface Messages {
  ScanBars: ScanBars;
  PulseStagger: PulseStagger;
  RadarSettings: RadarSettings;
  Pose: Pose;
  Material: Material;
  FrameDescriptor: FrameDescriptor;
  LoadedGround: LoadedGround;
  ElevationModel: ElevationModel;
  BuildingHeights: BuildingHeights;
  SourceError: SourceError;
  FrameSummary: FrameSummary;
  BinWindow: BinWindow;
  Hello: Hello;
  Welcome: Welcome;
  Limits: Limits;
  Ack: Ack;
  FieldFault: FieldFault;
  Error: Error;
  Heartbeat: Heartbeat;
  ListRadars: ListRadars;
  RadarList: RadarList;
  GetRadar: GetRadar;
  RadarInfo: RadarInfo;
  ClaimControl: ClaimControl;
  ReleaseControl: ReleaseControl;
  SetSettings: SetSettings;
  SetPose: SetPose;
  SetState: SetState;
  Subscribe: Subscribe;
  Unsubscribe: Unsubscribe;
  RenderOnce: RenderOnce;
  QueryGround: QueryGround;
  GroundAnswer: GroundAnswer;
  SetReplay: SetReplay;
  ReplayState: ReplayState;
  TargetRoute: TargetRoute;
  Target: Target;
  SetTargets: SetTargets;
  GetTargets: GetTargets;
  TargetList: TargetList;
  TargetType: TargetType;
  GetStatus: GetStatus;
  RadarStatus: RadarStatus;
  Status: Status;
  ResetExercise: ResetExercise;
  SetExercise: SetExercise;
  GetExercise: GetExercise;
  RadarState: RadarState;
  ExerciseState: ExerciseState;
  PlatformState: PlatformState;
  LoadExercise: LoadExercise;
  ExerciseEvent: ExerciseEvent;
  GetEvents: GetEvents;
  ExerciseEvents: ExerciseEvents;
  AddBookmark: AddBookmark;
  ScanPass: ScanPass;
  AzimuthSpan: AzimuthSpan;
  FrameBegin: FrameBegin;
  WedgeBlock: WedgeBlock;
  TargetBlock: TargetBlock;
  FrameEnd: FrameEnd;
  FrameAbort: FrameAbort;
}
