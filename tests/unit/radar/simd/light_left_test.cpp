// What buildings leave of a plane's light, from nodes to range bins: beside a search for each bin's edges.
#include "server/radar/simd/buildings/light_left.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "server/radar/simd/kernels.h"

namespace obliq::light_left_test {
namespace {

struct Profile {
  int n_range, n_nodes, stride;
  bool sines;
  std::vector<float> horizon, sine, range_bin, hidden;

  NodeProfiles nodes() {
    NodeProfiles of{};
    of.planes = 1;
    of.stride = stride;
    of.n_nodes = n_nodes;
    of.horizon = horizon.data();
    of.range_bin = range_bin.data();
    of.hidden = hidden.data();
    of.sine = sines ? sine.data() : nullptr;
    return of;
  }
};

/// A profile of any shape: bins longer and shorter than nodes lie apart, ground that begins unknown, houses
/// in places or everywhere.
Profile any_profile(std::mt19937& random) {
  std::uniform_real_distribution<float> share(0, 1);
  Profile p;
  p.n_range = std::uniform_int_distribution(1, 90)(random);
  p.n_nodes = std::uniform_int_distribution(9, 400)(random);
  p.stride = (p.n_nodes + 31) / 16 * 16;
  p.sines = share(random) < 0.3F;
  const float step = std::pow(10.0F, 2 * share(random) - 1.5F);
  const float many = share(random);
  const int unknown = share(random) < 0.2F ? std::uniform_int_distribution(1, 40)(random) : 0;
  const float turns = share(random) < 0.3F ? 0.2F : 0;
  float top = -1, bin = 10 * share(random) - 8, direction = 1;
  for (int k = 0; k < p.stride; ++k) {
    if (share(random) < 0.7F) top += 0.01F * share(random);
    if (share(random) < turns) direction = -direction;
    bin += direction * step * (0.5F + share(random));
    const bool known = k >= unknown;
    p.horizon.push_back(known ? top : -1e9F);
    p.sine.push_back(known ? top / std::sqrt(1 + top * top) : -1);
    p.range_bin.push_back(known ? bin : 1e12F);
    p.hidden.push_back(known && share(random) < many ? 0.01F * share(random) : 0);
  }
  return p;
}

/// Where an edge is passed for the first time, from a node on that is not behind `from`: how far to the left
/// of it nodes lie, and the rest of the way to the next. Light grows evenly from node to node.
struct UpTo {
  double visible = 0, hidden = 0;
};
UpTo up_to(const Profile& p, int node, double edge) {
  const auto& light = p.sines ? p.sine : p.horizon;
  UpTo sum;
  for (int k = node; k + 1 < p.n_nodes; ++k) {
    const auto at = static_cast<std::size_t>(k);
    const double here = p.range_bin[at], next = p.range_bin[at + 1];
    const bool passed = next > edge;
    const double part = !passed ? 1 : here < edge ? (edge - here) / (next - here) : 0;
    const double grows = static_cast<double>(light[at + 1]) - light[at];
    const double rises = static_cast<double>(p.horizon[at + 1]) - p.horizon[at];
    sum.visible += part * grows;
    sum.hidden += part * p.hidden[at] * (!p.sines ? 1 : rises > 0 ? grows / rises : 0);
    if (passed) break;
  }
  return sum;
}

TEST(LightLeft, IsWhatASearchForEachEdgeFinds) {
  std::mt19937 random(11);
  int with_some = 0;
  for (int turn = 0; turn < 2'000; ++turn) {
    SCOPED_TRACE("turn " + std::to_string(turn));
    Profile profile = any_profile(random);
    // The first node from which something is hidden, and the last before its bin.
    int node = 0;
    while (node + 1 < profile.n_nodes && !(profile.hidden[static_cast<std::size_t>(node)] > 0)) ++node;
    if (node + 1 == profile.n_nodes) continue;
    const int from =
        std::max(0, static_cast<int>(std::floor(profile.range_bin[static_cast<std::size_t>(node)])));
    while (node > 0 && profile.range_bin[static_cast<std::size_t>(node)] > static_cast<float>(from) &&
           profile.range_bin[static_cast<std::size_t>(node - 1)] < 1e11F)
      --node;
    const auto n = static_cast<std::size_t>(profile.n_range);
    std::vector<float> of_first_set;
    for (const Kernels& kernels : all_kernels()) {
      std::vector<double> visible(n + 1 + LightLeft::kSpare), hidden(visible);
      std::vector<float> left(n + LightLeft::kSpare);
      LightLeft light{visible.data(), hidden.data(), left.data(), -1, -1};
      kernels.light_left(profile.nodes(), 0, profile.n_range, light);
      ASSERT_TRUE(0 <= light.from && light.from <= light.to && light.to <= profile.n_range);
      std::vector<float> shares(n, 1.0F);
      std::copy(left.begin() + light.from, left.begin() + light.to, shares.begin() + light.from);
      if (of_first_set.empty()) of_first_set = shares;
      ASSERT_EQ(shares, of_first_set) << kernels.name;
    }
    for (int bin = from; bin < profile.n_range; ++bin) {
      const UpTo near = up_to(profile, node, bin), far = up_to(profile, node, bin + 1);
      const double grows = far.visible - near.visible, hides = far.hidden - near.hidden;
      const float found = of_first_set[static_cast<std::size_t>(bin)];
      ASSERT_TRUE(found >= 0 && found <= 1);
      if (!(grows > 1e-5 && hides > 1e-5)) continue;
      const double share = std::min(1.0, 1 - hides / grows);
      if (std::abs(share - 1.0 / 64) < 1e-3) continue;  // a gap or none
      ++with_some;
      ASSERT_NEAR(static_cast<double>(found), share < 1.0 / 64 ? 0 : share, 2e-6 / grows) << bin;
    }
  }
  EXPECT_GT(with_some, 20'000);
}

}  // namespace
}  // namespace obliq::light_left_test
