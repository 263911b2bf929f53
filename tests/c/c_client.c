/* What c_test.py asks of client/c.h, a line of output for each answer.
 *   c_client HOST:PORT RADAR */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "client/c.h"

static int said(const obliq_client* client, const char* what, int outcome) {
  if (outcome == OBLIQ_OK) return 0;
  printf("%s: outcome %d, error %u: %s\n", what, outcome, obliq_error_number(client), obliq_error(client));
  return 1;
}

/* FNV-1a. */
static unsigned long long sum_of(const void* bytes, size_t size) {
  const unsigned char* at = bytes;
  unsigned long long sum = 0xcbf29ce484222325ULL;
  for (size_t k = 0; k < size; ++k) sum = (sum ^ at[k]) * 0x100000001b3ULL;
  return sum;
}

static void print_frame(const char* what, const obliq_frame* f) {
  const size_t bins = (size_t)f->n_azimuth * (size_t)f->n_range;
  printf("%s %s %d %d bearing %g planes %d%d%d%d%d\n", what, f->radar, f->n_azimuth, f->n_range, f->pose.bearing_deg, f->iq != NULL,
         f->power_w != NULL, f->count != NULL, f->state != NULL, f->video != NULL);
  if (f->iq != NULL) printf("iq %016llx\n", sum_of(f->iq, bins * 2 * sizeof(float)));
  if (f->state != NULL) printf("state %016llx\n", sum_of(f->state, bins));
}

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  obliq_client* client = obliq_open();
  const char* radar = argv[2];
  obliq_pose pose;
  obliq_frame frame;
  char text[64];
  uint64_t request = 0;
  said(client, "before", obliq_claim(client, radar, 0));
  said(client, "nowhere", obliq_connect(client, "nowhere:at:all", "c", NULL));
  if (said(client, "connect", obliq_connect(client, argv[1], "c", NULL))) return 1;
  printf("radars %s %s\n", obliq_radar(client, 0), obliq_radar(client, 1) == NULL ? "-" : obliq_radar(client, 1));

  obliq_no_pose(&pose);
  pose.bearing_deg = 70;
  said(client, "without control", obliq_move(client, radar, &pose));
  said(client, "claim nothing", obliq_claim_part(client, radar, 0, 0));
  said(client, "claim the pose", obliq_claim_part(client, radar, OBLIQ_POSE, 0));
  said(client, "without settings", obliq_set(client, radar, "receiver_gain_db=6"));
  said(client, "claim", obliq_claim(client, radar, 0));
  said(client, "move", obliq_move(client, radar, &pose));
  said(client, "where", obliq_where(client, radar, &pose));
  printf("where %.3f %.3f %g %g\n", pose.latitude_deg, pose.longitude_deg, pose.height_m, pose.bearing_deg);
  said(client, "set", obliq_set(client, radar, "receiver_gain_db=6 azimuth_bins=32,speckle=NONE_SPECKLE range_normalisation=true"));
  said(client, "get", obliq_get(client, radar, "receiver_gain_db", text, sizeof text));
  printf("gain %s", text);
  said(client, "get", obliq_get(client, radar, "speckle", text, sizeof text));
  printf(" speckle %s\n", text);
  said(client, "bars", obliq_set(client, radar, "scan_bars=-2;-5.5 receiver_gain_db=6"));
  said(client, "get", obliq_get(client, radar, "scan_bars", text, sizeof text));
  printf("bars %s", text);
  said(client, "no bars", obliq_set(client, radar, "scan_bars="));
  said(client, "get", obliq_get(client, radar, "scan_bars", text, sizeof text));
  printf(" then \"%s\"\n", text);
  said(client, "wrong bars", obliq_set(client, radar, "scan_bars=-2;up"));
  said(client, "wrong name", obliq_set(client, radar, "gain=6"));
  said(client, "wrong number", obliq_set(client, radar, "azimuth_bins=1.5"));
  said(client, "wrong limits", obliq_set(client, radar, "sector_deg=500"));
  said(client, "no room", obliq_get(client, radar, "speckle", text, 3));

  said(client, "subscribe", obliq_subscribe(client, radar, 20, OBLIQ_IQ | OBLIQ_STATE));
  if (said(client, "receive", obliq_receive(client, &frame, 60000))) return 1;
  print_frame("frame", &frame);
  said(client, "unsubscribe", obliq_unsubscribe(client, radar));
  obliq_no_pose(&pose);
  pose.bearing_deg = 75;
  said(client, "render", obliq_render(client, radar, &pose, "azimuth_bins=8", OBLIQ_IQ | OBLIQ_VIDEO, &request));
  do {
    if (said(client, "receive", obliq_receive(client, &frame, 60000))) return 1;
  } while (frame.request_id != request);
  print_frame("rendered", &frame);
  printf("silence %d\n", obliq_receive(client, &frame, 50) == OBLIQ_TIMED_OUT);

  const double latitude[2] = {33.05, 80.0}, longitude[2] = {-99.45, 0.0};
  obliq_ground ground[2];
  said(client, "query", obliq_query(client, radar, 2, latitude, longitude, NULL, ground));
  printf("ground %d %.3f seen %d, %d\n", ground[0].is_known, ground[0].height_m, ground[0].is_seen, ground[1].is_known);

  obliq_event event;
  uint64_t number = 0;
  int events = -1;
  said(client, "bookmark", obliq_bookmark(client, "from C"));
  said(client, "no bookmark", obliq_bookmark(client, ""));
  do {
    if (said(client, "event", obliq_next_event(client, number, &event))) return 1;
    ++events;
    if (event.number != 0) number = event.number;
    if (event.kind == 10) printf("%s by %.1s of %s.\n", event.text, event.by, event.radar);
  } while (event.number != 0);
  printf("events %d\n", events);
  said(client, "no replay", obliq_go_to_event(client, 1));
  said(client, "release", obliq_release(client, radar));
  said(client, "unknown radar", obliq_claim(client, NULL, 0));
  obliq_close(client);
  obliq_close(NULL);
  return 0;
}
