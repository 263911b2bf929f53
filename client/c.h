#pragma once
/* The client library for C and for what calls C: connect, move, set, receive, query, set targets. No C++ type
 * and no exception crosses it. A client is for one thread at a time; texts are UTF-8. Functions return an
 * obliq_outcome; obliq_error() then has the sentence. */
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct obliq_client obliq_client;

enum obliq_outcome {
  OBLIQ_OK = 0,
  OBLIQ_BAD_ARGUMENT = 1,   /* of the caller */
  OBLIQ_CANNOT_CONNECT = 2, /* nothing listens there, or the name is unknown */
  OBLIQ_TIMED_OUT = 3,
  OBLIQ_CLOSED = 4, /* the server has gone */
  OBLIQ_BAD_STREAM = 5,
  OBLIQ_REFUSED = 6, /* obliq_error_number() says why: PROTOCOL.md, "Errors" */
  OBLIQ_ABORTED = 7, /* a frame that had begun was ended by the server */
  OBLIQ_UNTRUSTED = 8,
  OBLIQ_FAILED = 9 /* no memory, or a fault of the library */
};

/* Of obliq_claim_part(), to be added. */
enum obliq_claims { OBLIQ_POSE = 1, OBLIQ_SETTINGS = 2 };

/* Planes of a frame, to be added. */
enum obliq_planes {
  OBLIQ_IQ = 1,
  OBLIQ_POWER = 2,
  OBLIQ_COUNT = 4,
  OBLIQ_STATE = 8,
  OBLIQ_VIDEO = 16,
  OBLIQ_MATERIAL = 64, /* labels: PROTOCOL.md, "Labels" */
  OBLIQ_BUILDING = 128,
  OBLIQ_HEIGHT = 256,
  OBLIQ_RETURNS = 512,
  OBLIQ_TARGET = 1024, /* PROTOCOL.md, "Truth" */
  /* Beside planes, none themselves: */
  OBLIQ_TRUTH = 65536,        /* where targets are: obliq_frame.truth */
  OBLIQ_LIVE_TARGETS = 131072 /* of obliq_render(): the world's targets are in the frame */
};

enum obliq_height_reference { OBLIQ_DATUM = 0, OBLIQ_GROUND = 1, OBLIQ_ELLIPSOID = 2 };

/* What hides a target or part of it. */
enum obliq_hidden_by {
  OBLIQ_HIDDEN_BY_NOTHING = 0,
  OBLIQ_HIDDEN_BY_GROUND = 1,
  OBLIQ_HIDDEN_BY_BUILDING = 2,
  OBLIQ_HIDDEN_BY_HORIZON = 3,
  OBLIQ_HIDDEN_BY_UNKNOWN_GROUND = 4 /* nothing known hides it, but the line passes over ground not known */
};

/* Where the antenna is and where it looks, as Pose in obliq.proto. NaN (obliq_no_pose) leaves a value as it
 * is. */
typedef struct obliq_pose {
  double latitude_deg;
  double longitude_deg;
  double height_m; /* above the radar's height_reference */
  double bearing_deg;
  double tilt_deg;
  double valid_s;
  int64_t sim_time_ns;       /* INT64_MIN: none */
  uint64_t pose_id;          /* 0: none */
  double heading_deg;        /* of the platform's nose */
  double velocity_north_m_s; /* of the antenna over the ground; NaN of a frame: not known */
  double velocity_east_m_s;
  double velocity_up_m_s;
  double roll_deg;  /* of the platform, right side down */
  double pitch_deg; /* nose up */
} obliq_pose;

/* Where a target of the world is in a frame, seen or not: PROTOCOL.md, "Truth". */
typedef struct obliq_truth {
  uint64_t id;
  double latitude_deg; /* of its foot */
  double longitude_deg;
  double height_m;    /* above the datum */
  double bearing_deg; /* true, from the antenna, 0 to 360 */
  double range_m;     /* slant range */
  double elevation_deg;
  double closing_m_s; /* of target and antenna together; positive: the range falls */
  double snr_db;      /* in the middle of beam and pulse; -1000: nothing is seen */
  double rcs_dbsm;    /* as drawn for this look */
  double share_seen;  /* 0 to 1 */
  int azimuth_bin;    /* -1: none */
  int range_bin;      /* -1: none */
  int hidden_by;      /* one of obliq_hidden_by */
  int is_power;       /* 1: snr_db is the echo's power in dBW, for the receiver has no noise */
} obliq_truth;

/* A whole frame. Planes are [n_azimuth][n_range]; those not asked for are NULL. Everything it points to lives
 * until the next obliq_receive() or obliq_close(). */
typedef struct obliq_frame {
  const char* radar;
  uint64_t frame_id;
  uint64_t request_id; /* of obliq_render(); 0: a subscription's */
  uint64_t frames_skipped;
  int n_azimuth;
  int n_range;
  double azimuth_start_deg; /* left edge of the first azimuth bin, true bearing */
  double azimuth_width_deg;
  double range_start_m; /* near edge of the first range bin, slant range */
  double range_spacing_m;
  double video_floor_db; /* of video level 1 */
  double video_span_db;
  obliq_pose pose;
  const float* iq; /* real and imaginary part of each bin */
  const double* power_w;
  const uint32_t* count;
  const uint8_t* state;
  const uint16_t* video;   /* levels 0 to 255 */
  const uint8_t* material; /* 255: none */
  const float* building;
  const float* height_m; /* NaN: none */
  const uint8_t* returns;
  const uint32_t* target;   /* the strongest in the bin: the last 32 bits of its id; 0: none */
  const obliq_truth* truth; /* [n_truth], where OBLIQ_TRUTH was asked for; of a pass dwell by dwell */
  size_t n_truth;
} obliq_frame;

/* What is at a place of the ground, and whether the antenna sees it. */
typedef struct obliq_ground {
  double height_m;         /* of the ground, above the datum */
  double surface_height_m; /* with a roof on it */
  double slope_deg;
  double clearance_deg; /* by which the point clears what stands before it; negative: hidden */
  int is_known;
  int is_seen; /* 1: from the antenna; 0: hidden; -1: not known */
  int is_water;
  uint32_t building; /* from 1; 0: none */
} obliq_ground;

/* Where a target goes from its place: to each of n points in turn. n 0: it follows no route any more. */
typedef struct obliq_route {
  size_t n;
  const double* latitude_deg;
  const double* longitude_deg;
  const double* height_m;  /* above the target's height_reference; NULL: the target's own */
  const double* speed_m_s; /* on the way to each */
  int loops;               /* back to its first place, and round again */
} obliq_route;

/* A vehicle, ship or aircraft of the world, as Target in obliq.proto. NaN, NULL, -1 and INT64_MIN
 * (obliq_no_target) leave a value as it is; of a new id they are its type's value, or the default. A new one
 * needs a latitude and a longitude. */
typedef struct obliq_target {
  uint64_t id;         /* from 1 */
  const char* name;    /* NULL: as it is */
  const char* type;    /* of the scene's [target_types.NAME]; "": none; NULL: as it is */
  double latitude_deg; /* of its foot */
  double longitude_deg;
  double height_m;           /* above height_reference */
  int height_reference;      /* one of obliq_height_reference; -1: as it is */
  double geoid_undulation_m; /* of OBLIQ_ELLIPSOID */
  double velocity_north_m_s; /* along its own north, east and up; not beside a route */
  double velocity_east_m_s;
  double velocity_up_m_s;
  double acceleration_north_m_s2;
  double acceleration_east_m_s2;
  double acceleration_up_m_s2;
  double heading_deg; /* of its nose; NaN of a new one: along its course */
  double heading_rate_deg_s;
  double rcs_dbsm; /* mean radar cross section */
  int swerling;    /* 0 to 4; -1: as it is */
  double length_m; /* of what echoes; 0: a point */
  double width_m;
  double top_m;             /* over its foot */
  int64_t sim_time_ns;      /* of place and motion, by the clock of the poses; INT64_MIN: of its arrival */
  double age_s;             /* place and motion were so this long ago; not beside sim_time_ns */
  double valid_s;           /* it goes so long after its arrival; 0: never */
  const obliq_route* route; /* in place of a velocity; NULL: as it is */
} obliq_target;

/* Who changed what of an exercise, and when. Texts live until the next obliq_next_event() or obliq_close().
 */
typedef struct obliq_event {
  uint64_t number; /* from 1 */
  int64_t utc_ns;
  int kind;          /* as EventKind in obliq.proto; 10: a bookmark */
  const char* by;    /* the client's name */
  const char* radar; /* "": all */
  const char* text;  /* of a bookmark */
} obliq_event;

/* A client that is not connected yet; NULL: no memory. */
obliq_client* obliq_open(void);
void obliq_close(obliq_client* client);

/* address: "127.0.0.1:7420". name: shown to others. token: NULL where the server wants none. */
int obliq_connect(obliq_client* client, const char* address, const char* name, const char* token);

/* The sentence of the newest call that did not end with OBLIQ_OK; "" before one. Lives until the next call.
 */
const char* obliq_error(const obliq_client* client);
/* Of OBLIQ_REFUSED; else 0. */
uint32_t obliq_error_number(const obliq_client* client);

/* What the newest call did, but doubts or left out in part: a sentence a line; "": nothing. Of obliq_move(),
 * obliq_set(), obliq_set_targets() and obliq_remove_targets(). Lives until the next call. */
const char* obliq_warnings(const obliq_client* client);

/* Names of the server's radars, from 0; NULL past the last. */
const char* obliq_radar(const obliq_client* client, int index);

/* Moving needs a radar's pose, setting its settings: both. force: from another client, for an admin. */
int obliq_claim(obliq_client* client, const char* radar, int force);
/* claims: those alone, all or none, so that a host flies a radar while another client turns its knobs. */
int obliq_claim_part(obliq_client* client, const char* radar, unsigned claims, int force);
/* All that this client holds. */
int obliq_release(obliq_client* client, const char* radar);

void obliq_no_pose(obliq_pose* pose);
int obliq_move(obliq_client* client, const char* radar, const obliq_pose* pose);
int obliq_where(obliq_client* client, const char* radar, obliq_pose* pose);

/* settings: "receiver_gain_db=6 scan_mode=SECTOR_SCAN noise=true", by the names of RadarSettings; all or none
 * change. A list has ; between its numbers: "scan_bars=-2;-5", and an empty one nothing: "scan_bars=". */
int obliq_set(obliq_client* client, const char* radar, const char* settings);
/* The value of one of them as text, as obliq_set() takes it. */
int obliq_get(obliq_client* client, const char* radar, const char* setting, char* text, size_t size);

/* Of a radar the newest counts; one that is refused changes nothing. */
int obliq_subscribe(obliq_client* client, const char* radar, double rate_hz, unsigned planes);
int obliq_unsubscribe(obliq_client* client, const char* radar);
/* One frame of its own: as the live radar is, but for pose (NULL: as it stands) and settings (NULL: as they
 * are). It comes by obliq_receive() with this request_id. */
int obliq_render(obliq_client* client, const char* radar, const obliq_pose* pose, const char* settings,
                 unsigned planes, uint64_t* request_id);
/* Waits for the next whole frame. OBLIQ_TIMED_OUT leaves the connection usable. */
int obliq_receive(obliq_client* client, obliq_frame* frame, int timeout_ms);

/* n places, as the radar's antenna sees them from where it is now. height_m: of points there above the datum;
 * NULL: on the ground. */
int obliq_query(obliq_client* client, const char* radar, size_t n, const double* latitude_deg,
                const double* longitude_deg, const double* height_m, obliq_ground* ground);

/* Targets belong to the world: all radars see them. One client at a time may set them; they stay when it
 * leaves. */
int obliq_claim_targets(obliq_client* client, int force);
int obliq_release_targets(obliq_client* client);
void obliq_no_target(obliq_target* target);
/* n targets at once, all or none, each id once. clear: others go at the same moment; with n 0 all go. */
int obliq_set_targets(obliq_client* client, size_t n, const obliq_target* targets, int clear);
/* Ids that the world has not are no fault. */
int obliq_remove_targets(obliq_client* client, size_t n, const uint64_t* ids);
/* The target with the next id behind `after`; none: its id is 0. after 0 asks the server, others go on in
 * what it said. Needs the server's truth role. Texts and route live until the next call with after 0. */
int obliq_next_target(obliq_client* client, uint64_t after, obliq_target* target);

/* A text at this moment of the exercise, or at the place of a replay, for all stations; for a controller. */
int obliq_bookmark(obliq_client* client, const char* text);
/* The oldest event behind number `after` (0: of all) that the server has; none: its number is 0. */
int obliq_next_event(obliq_client* client, uint64_t after, obliq_event* event);
/* Takes a server that replays a recording, for all stations, to the time of an event. */
int obliq_go_to_event(obliq_client* client, uint64_t number);

#ifdef __cplusplus
}
#endif
