#pragma once
// `obliq fly --udp` and `--dis`: a radar rides on a simulator's own aircraft or ship. dis/README.md has
// the datagrams.
#include <string>
#include <vector>

#include "client/resuming_client.h"
#include "server/apps/commands/fly/fly_targets.h"

namespace CLI {
class App;
}

namespace obliq {

struct DatagramSource {
  int udp_port = -1;               ///< of poses, or with `entity` of PDUs; -1: none
  bool dis = false;                ///< an ownship of DIS, or targets alone
  std::string entity;              ///< SITE:APP:ENTITY; empty: poses, or targets alone
  std::string address;             ///< to bind to; a multicast group is joined
  std::string interface;           ///< on which; empty: as the routes say
  int exercise = -1;               ///< of DIS; -1: any
  double look_deg = 0;             ///< of the sector's centre, from the nose
  double undulation_m = 0;         ///< of the geoid, for heights of DIS
  double time_rate = 1;            ///< seconds of the datagrams' clock in a second
  std::vector<std::string> allow;  ///< networks; empty: from all
  std::string clock;               ///< of PDUs: arrival, absolute
  TargetOptions targets;
  bool is_dis() const { return dis || targets.wanted; }
  bool wanted() const { return udp_port >= 0 || is_dis(); }
};

void add_datagram_options(CLI::App& command, DatagramSource& source);

/// Says where the nose points; the sector's centre is `look_deg` from it at first, and then where its
/// operator turns it.
void set_heading(const client::Client& client, bool first, double heading_deg, double look_deg,
                 wire::Pose& pose);

/// Until interrupted. rate_hz: of poses between an entity's PDUs. Throws InputError.
void fly_by_datagrams(client::Client connected, const std::string& radar, const DatagramSource& source,
                      double rate_hz, const std::string& height_reference, double height_unit_m,
                      int reconnect_s);

/// Whether a request failed because the connection is lost: then receive() takes it up again.
bool is_lost(const client::ResumingClient& client, const client::Status& status);

}  // namespace obliq
