#pragma once
// `obliq fly --dis --targets`: the entities of a DIS exercise become the world's targets. dis/README.md has
// the rules.
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "client/resuming_client.h"
#include "server/apps/dis/entity_target.h"
#include "server/apps/dis/pdu_clock.h"

namespace CLI {
class App;
}

namespace obliq {

class FlyNews;
struct DatagramSource;

struct TargetOptions {
  bool wanted = false;
  std::string types_file;           ///< empty: none
  double refresh_hz = 5;            ///< of those on curves
  std::uint64_t most = 10000;       ///< of targets
  std::optional<double> timeout_s;  ///< empty: by the heartbeats of DIS
  bool on_ground = false;
};

void add_target_options(CLI::App& command, TargetOptions& options);

/// Feeds the world's targets from entities, whose motions it keeps. Throws InputError where the server
/// refuses for good.
class TargetFeed {
 public:
  using Time = EntityTable::Time;

  /// Claims the targets. start: where sim_time_ns begins, the same as of the ownship's poses; empty: no
  /// ownship is flown, and targets go by their arrival. radar: near which entities count where there are too
  /// many and no ownship is.
  TargetFeed(client::ResumingClient& client, FlyNews& news, const DatagramSource& source,
             std::optional<EntityId> ownship, std::optional<Time> start, std::string radar);

  void take(const EntityState& state, Time stamped, Time arrived);
  void obey(const SimulationOrder& order, Time now) { table_.obey(order, now); }
  /// Where the ownship is, in the earth's axes.
  void set_centre(const glm::dvec3& centre_m) { centre_m_ = centre_m; }
  /// The connection was lost and is back: the server may know nothing of before.
  void note_loss() { table_.forget_sent(); }

  /// Sends what has changed, at most twenty times a second. False when the connection is lost.
  bool send(Time now);
  /// "12 entities, 3 left out ...".
  std::string summary() const;
  void release();

 private:
  /// known: those of the server; empty: it does not tell.
  TargetFeed(client::ResumingClient& client, FlyNews& news, const DatagramSource& source,
             std::optional<EntityId> ownship, std::optional<Time> start, std::string radar,
             const std::optional<wire::TargetList>& known);
  void find_centre(Time now);
  bool send(const wire::SetTargets& change);

  client::ResumingClient& client_;
  FlyNews& news_;
  const EntityHeights heights_;
  const std::optional<Time> start_;
  const std::string radar_;
  std::optional<glm::dvec3> centre_m_;
  bool has_ownship_;
  Time next_centre_{}, next_batch_{};
  EntityKinds kinds_;
  EntityTable table_;
  std::uint64_t sent_ = 0;
  std::uint64_t none_ = 0;     ///< PDUs of entities that no type has
  std::uint64_t beyond_ = 0;   ///< outside the limits of a target
  std::size_t told_left_ = 0;  ///< out
};

/// Says every ten seconds how it goes, where that has changed.
class FeedStatus {
 public:
  /// understood: PduSource::understood(), whose change alone is no news.
  void tell(const std::string& text, const std::string& understood, TargetFeed::Time now);

 private:
  std::string told_;
  TargetFeed::Time next_{};
};

/// Without an ownship, until interrupted. Throws InputError.
void feed_targets(client::Client connected, const DatagramSource& source, const std::string& radar,
                  int reconnect_s);

}  // namespace obliq
