/* What c_targets_test.py asks of the targets of client/c.h, a line of output for each answer.
 *   c_targets HOST:PORT RADAR TOKEN VIEWERS_TOKEN */
#include <math.h>
#include <stdio.h>

#include "client/c.h"

static int said(const obliq_client* client, const char* what, int outcome) {
  if (outcome == OBLIQ_OK && *obliq_warnings(client) != 0) printf("%s warns: %s", what, obliq_warnings(client));
  if (outcome == OBLIQ_OK) return 0;
  printf("%s: outcome %d, error %u: %s\n", what, outcome, obliq_error_number(client), obliq_error(client));
  return 1;
}

static obliq_target at(uint64_t id, double latitude_deg, double longitude_deg) {
  obliq_target target;
  obliq_no_target(&target);
  target.id = id;
  target.latitude_deg = latitude_deg;
  target.longitude_deg = longitude_deg;
  return target;
}

static void list(obliq_client* client, const char* what) {
  obliq_target target;
  uint64_t id = 0;
  for (;;) {
    if (said(client, what, obliq_next_target(client, id, &target)) || target.id == 0) return;
    id = target.id;
    printf("%s %llu \"%s\" %s %.3f %.3f %g over %d, %g dBsm, Swerling %d, north %g, heading %g, valid %g s, %s", what,
           (unsigned long long)id, target.name != NULL ? target.name : "-", target.type != NULL ? target.type : "-",
           target.latitude_deg, target.longitude_deg, target.height_m, target.height_reference, target.rcs_dbsm, target.swerling,
           target.velocity_north_m_s, target.heading_deg, target.valid_s, target.sim_time_ns == INT64_MIN ? "of its arrival" : "timed");
    if (target.route != NULL) {
      const obliq_route* r = target.route;
      printf(", route of %d to %.2f %.2f at %g m/s, %g m, loops %d", (int)r->n, r->latitude_deg[r->n - 1],
             r->longitude_deg[r->n - 1], r->speed_m_s[r->n - 1], r->height_m[r->n - 1], r->loops);
    }
    printf("\n");
  }
}

static void mistakes(obliq_client* client) {
  obliq_target few[2] = {at(1, 33.0, -99.0), at(1, 33.0, -99.0)};
  obliq_target many[21];
  double places[2] = {33.0, 33.1};
  static const double long_list[10000];
  obliq_route route = {2, places, places, NULL, NULL, 0};
  said(client, "an id twice", obliq_set_targets(client, 2, few, 0));
  few[0].id = 0;
  said(client, "no id", obliq_set_targets(client, 1, few, 0));
  few[0] = at(50, NAN, -99.0);
  said(client, "NaN of a new one", obliq_set_targets(client, 1, few, 0));
  few[0] = at(1, INFINITY, -99.0);
  said(client, "infinite", obliq_set_targets(client, 1, few, 0));
  few[0] = at(1, 33.0, -99.0);
  few[0].swerling = 7;
  few[0].height_reference = 9;
  said(client, "no such choices", obliq_set_targets(client, 1, few, 0));
  few[0] = at(1, 33.0, -99.0);
  few[0].type = "tank";
  said(client, "unknown type", obliq_set_targets(client, 1, few, 0));
  few[0].type = NULL;
  few[0].name = "\xff";
  said(client, "no UTF-8", obliq_set_targets(client, 1, few, 0));
  few[0].name = NULL;
  few[0].route = &route;
  said(client, "no speeds", obliq_set_targets(client, 1, few, 0));
  route.speed_m_s = places;
  few[0].velocity_up_m_s = 1;
  said(client, "route and velocity", obliq_set_targets(client, 1, few, 0));
  for (int k = 0; k < 21; ++k) many[k] = at(100 + (uint64_t)k, 33.0, -99.0);
  said(client, "too many", obliq_set_targets(client, 21, many, 0));
  said(client, "too many by far", obliq_set_targets(client, (size_t)-1, many, 0));
  said(client, "no array", obliq_set_targets(client, 3, NULL, 0));
  said(client, "no ids", obliq_remove_targets(client, 1, NULL));
  said(client, "no place for it", obliq_next_target(client, 0, NULL));
  said(client, "no frame", obliq_receive(client, NULL, 0));
  said(client, "no event", obliq_next_event(client, 0, NULL));
  said(client, "no places", obliq_query(client, "main", 1, places, NULL, NULL, NULL));
  obliq_no_target(NULL);
  obliq_no_pose(NULL);
  few[0] = at(1, 33.0, -99.0);
  few[0].route = &route;
  route.latitude_deg = route.longitude_deg = route.speed_m_s = long_list;
  route.n = sizeof long_list / sizeof *long_list;
  said(client, "long route", obliq_set_targets(client, 1, few, 0));
}

static void print_truth(const char* what, const obliq_frame* f) {
  size_t of_first = 0;
  const size_t bins = (size_t)f->n_azimuth * (size_t)f->n_range;
  for (size_t k = 0; f->target != NULL && k < bins; ++k) of_first += f->target[k] == 1;
  printf("%s %s: %d targets, in bins %d, power %d\n", what, f->radar, (int)f->n_truth, (int)of_first, f->power_w != NULL);
  for (size_t k = 0; k < f->n_truth; ++k) {
    const obliq_truth* t = &f->truth[k];
    printf("truth %llu %.6f %.6f %.3f bearing %.4f range %.2f elevation %.4f closing %.3f snr %.3f rcs %.3f seen %.3f bin %d %d by %d "
           "power %d\n",
           (unsigned long long)t->id, t->latitude_deg, t->longitude_deg, t->height_m, t->bearing_deg, t->range_m, t->elevation_deg,
           t->closing_m_s, t->snr_db, t->rcs_dbsm, t->share_seen, t->azimuth_bin, t->range_bin, t->hidden_by, t->is_power);
  }
}

static int frames(obliq_client* client, const char* radar) {
  obliq_frame frame;
  uint64_t request = 0;
  said(client, "unknown plane", obliq_subscribe(client, radar, 20, 2048));
  said(client, "truth without planes", obliq_subscribe(client, radar, 20, OBLIQ_TRUTH));
  said(client, "not of a subscription", obliq_subscribe(client, radar, 20, OBLIQ_POWER | OBLIQ_LIVE_TARGETS));
  /* What came of the subscription before has other planes. */
  said(client, "subscribe", obliq_subscribe(client, radar, 50, OBLIQ_STATE));
  if (said(client, "receive", obliq_receive(client, &frame, 60000))) return 1;
  said(client, "subscribe", obliq_subscribe(client, radar, 20, OBLIQ_TARGET | OBLIQ_POWER | OBLIQ_TRUTH));
  if (said(client, "receive", obliq_receive(client, &frame, 60000))) return 1;
  print_truth("frame", &frame);
  said(client, "unsubscribe", obliq_unsubscribe(client, radar));
  said(client, "render", obliq_render(client, radar, NULL, "azimuth_bins=16", OBLIQ_TARGET | OBLIQ_TRUTH | OBLIQ_LIVE_TARGETS, &request));
  do {
    if (said(client, "receive", obliq_receive(client, &frame, 60000))) return 1;
  } while (frame.request_id != request);
  print_truth("rendered", &frame);
  said(client, "render", obliq_render(client, radar, NULL, NULL, OBLIQ_TARGET, &request));
  do {
    if (said(client, "receive", obliq_receive(client, &frame, 60000))) return 1;
  } while (frame.request_id != request);
  print_truth("bare", &frame);
  return 0;
}

/* One that may not be told goes on with what it had. */
static void viewer(const char* address, const char* radar, const char* token) {
  obliq_client* client = obliq_open();
  obliq_target target;
  obliq_frame frame;
  said(client, "viewer connects", obliq_connect(client, address, "viewer", token));
  said(client, "viewer subscribes", obliq_subscribe(client, radar, 20, OBLIQ_STATE));
  said(client, "viewer asks for truth", obliq_subscribe(client, radar, 20, OBLIQ_POWER | OBLIQ_TRUTH));
  said(client, "viewer asks for the plane", obliq_subscribe(client, radar, 20, OBLIQ_TARGET));
  said(client, "viewer lists", obliq_next_target(client, 0, &target));
  said(client, "viewer claims", obliq_claim_targets(client, 0));
  for (int k = 0; k < 2; ++k)
    if (said(client, "viewer receives", obliq_receive(client, &frame, 60000))) return;
  printf("viewer's frame: state %d, power %d, truth %d\n", frame.state != NULL, frame.power_w != NULL, frame.truth != NULL);
  obliq_close(client);
}

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  obliq_client* client = obliq_open();
  const char* radar = argv[2];
  obliq_target targets[3];
  const double latitudes[2] = {33.01, 33.02}, longitudes[2] = {-99.44, -99.43}, speeds[2] = {10, 20};
  const obliq_route route = {2, latitudes, longitudes, NULL, speeds, 1};
  const uint64_t gone[2] = {2, 77};
  said(client, "before", obliq_claim_targets(client, 0));
  if (said(client, "connect", obliq_connect(client, argv[1], "c", argv[3]))) return 1;
  targets[0] = at(1, 33.02, -99.45);
  said(client, "without claim", obliq_set_targets(client, 1, targets, 0));
  said(client, "claim", obliq_claim_targets(client, 0));

  targets[0].type = "truck";
  targets[0].name = "\xc3\xa9" "clair";
  targets[0].sim_time_ns = 5;
  targets[1] = at(2, 33.03, -99.46);
  targets[1].height_m = 900;
  targets[1].height_reference = OBLIQ_DATUM;
  targets[1].velocity_north_m_s = 12;
  targets[1].rcs_dbsm = 20;
  targets[1].heading_deg = 90;
  targets[1].valid_s = 1000;
  targets[2] = at(UINT64_MAX, 33.0, -99.45);
  targets[2].route = &route;
  targets[2].sim_time_ns = 5;
  said(client, "set", obliq_set_targets(client, 3, targets, 0));
  list(client, "set");
  mistakes(client);

  obliq_no_target(&targets[0]);
  targets[0].id = 1;
  targets[0].rcs_dbsm = 50;
  said(client, "change", obliq_set_targets(client, 1, targets, 0));
  targets[0].velocity_north_m_s = 3;
  targets[0].sim_time_ns = 4;
  said(client, "late", obliq_set_targets(client, 1, targets, 0));
  said(client, "remove", obliq_remove_targets(client, 2, gone));
  list(client, "left");
  targets[0] = at(1, 33.02, -99.45);
  targets[0].type = "truck";
  targets[0].rcs_dbsm = 60;
  targets[1] = at(8, 30.0, -99.45);
  targets[1].swerling = 0;
  said(client, "replace", obliq_set_targets(client, 2, targets, 1));
  if (frames(client, radar)) return 1;
  viewer(argv[1], radar, argv[4]);
  said(client, "clear", obliq_set_targets(client, 0, NULL, 1));
  list(client, "cleared");
  said(client, "release", obliq_release_targets(client));
  said(client, "released", obliq_release_targets(client));
  obliq_close(client);
  return 0;
}
