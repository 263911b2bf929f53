#pragma once
// A server over level ground, and clients that set and see targets.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tests/integration/daemon.h"
#include "tests/integration/net_fixture.h"
#include "tests/support/target_scenes.h"

namespace obliq::wire {
class RenderOnce;
class SetTargets;
class Target;
class TargetList;
}  // namespace obliq::wire

namespace obliq::test {

inline constexpr const char* kViewer = "viewer-token-0123456789";
inline constexpr const char* kController = "controller-token-0123456789";
inline constexpr const char* kAdmin = "admin-token-0123456789";

/// The antenna is 1 km over the ground and looks north.
class NetTargets : public testing::Test {
 protected:
  NetTargets();
  ~NetTargets() override;

  void with_tokens();
  void serve();
  client::Client connect(const std::string& token = "", const std::string& name = "tester");
  /// With the claim of targets.
  client::Client holder(const std::string& token = "");

  /// So far to the north and east on the ground, that stands there; 30 dBsm, steady.
  wire::Target target(std::uint64_t id, double north_m, double east_m = 0) const;
  static wire::SetTargets request_of(const std::vector<wire::Target>& targets);
  static client::Status set(client::Client& client, const wire::SetTargets& request);
  static client::Status set(client::Client& client, const std::vector<wire::Target>& targets);
  static wire::TargetList list_of(client::Client& client);

  /// The power plane of radar "main" as it is.
  wire::RenderOnce frame_request(bool live, bool truth, std::int64_t sim_time_ns = 0) const;
  static client::AssembledFrame render(client::Client& client, const wire::RenderOnce& request);

  TestFolder folder_;
  TargetScene scene_{level_world()};
  RadarConfig radar_;
  net::ServerOptions options_;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace obliq::test
