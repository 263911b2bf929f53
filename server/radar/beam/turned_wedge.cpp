#include "server/radar/beam/turned_wedge.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "terrain/base/asking.h"
#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr std::size_t kTile = EchoPlan::kTile;

class Turning {
 public:
  Turning(const EchoPlan& plan, const EchoRows::Ready& ground, const SharpPlanes& planes)
      : plan_(plan),
        from_(*plan.ground),
        ready_(ground),
        first_row_(from_.rows.first_row(ground.azimuths.first)),
        wedge_(std::make_shared<SharpWedge>(plan, ground.azimuths, planes)),
        stride_(wedge_->stride),
        tile_power_(wedge_->kernels.size()),
        tile_sine_(wedge_->kernels.size()) {
    wedge_->stats = ground.stats;
  }

  std::shared_ptr<SharpWedge> turned() {
    // Rows that go all the way round come once.
    const auto n = std::min(ready_.rows.size(), static_cast<std::size_t>(from_.rows.n_rows));
    for (std::size_t k = 0; k < n; ++k) add_row(*ready_.rows[k], azimuth_of(static_cast<int>(k)));
    for (std::size_t tile = 0; tile < tile_power_.size(); ++tile)
      if (tile_power_[tile] > 0)
        wedge_->kernels[tile] =
            static_cast<std::uint8_t>(cosine_steps::nearest(tile_sine_[tile] / tile_power_[tile]));
    for (int a = 0; a < ready_.azimuths.count; ++a) take_ground(a);
    return wedge_;
  }

 private:
  int azimuth_of(int k) const { return from_.rows.sharp_azimuth(first_row_ + k); }

  /// Where in the wedge a scan angle is; -1: in another.
  int place_of(int row) const {
    const int place = plan_.sharp_azimuth(row) - ready_.azimuths.first;
    return place >= 0 && place < ready_.azimuths.count ? place : -1;
  }

  void add_row(const SharpWedge& ground, int azimuth) {
    ask(static_cast<std::int64_t>(ground.n_range));
    const std::size_t first = ground.row_at(azimuth);
    for (std::size_t r = 0; r < static_cast<std::size_t>(ground.n_range); ++r) {
      const std::size_t at = first + r;
      if (!(ground.power[at] > 0)) continue;
      const float seen = ground.seen_at[at];
      const float left = std::floor(seen);
      const float share = seen - left;
      const int row = static_cast<int>(left);
      if (const int place = place_of(row); place >= 0) add_bin(ground, at, place, r, 1 - share);
      if (const int place = place_of(row + 1); place >= 0) add_bin(ground, at, place, r, share);
    }
  }

  void add_bin(const SharpWedge& ground, std::size_t at, int place, std::size_t r, float share) {
    const std::size_t to = static_cast<std::size_t>(place) * stride_ + r;
    const float power_w = share * ground.power[at];
    wedge_->power[to] += power_w;
    if (!wedge_->mean_sine.empty() && wedge_->power[to] > 0)
      wedge_->mean_sine[to] += (ground.own_sine[at] - wedge_->mean_sine[to]) * (power_w / wedge_->power[to]);
    tile_power_[to / kTile] += static_cast<double>(power_w);
    tile_sine_[to / kTile] += static_cast<double>(power_w) * static_cast<double>(ground.own_sine[at]);
    if (!wedge_->iq.empty()) {
      wedge_->iq[2 * to] += share * ground.iq[2 * at];
      wedge_->iq[2 * to + 1] += share * ground.iq[2 * at + 1];
    }
    for (const LabelShare& label : ground.label_powers) {
      std::vector<float>& row = wedge_->label_row_of(label.kind);
      row[to] += share * label.share[at];
    }
  }

  /// Sharp azimuth of level ground that a scan angle sees at a range, a fraction; counted on where it wraps.
  double level_azimuth(SinCos scan, double range_m) const {
    const double sine = -std::clamp(from_.above_ground_m / range_m, -1.0, 1.0);
    return (from_.axes.azimuth_seen_rad(scan, sine) - from_.start_rad) / from_.azimuth_rad;
  }

  void take_ground(int a) {
    constexpr int kAzimuth = 400;  // of one, in units of ask()
    const auto n_range = static_cast<std::size_t>(wedge_->n_range);
    const double scan_rad = from_.scan_start_rad + (ready_.azimuths.first + a + 0.5) * from_.azimuth_rad;
    const SinCos scan = sincos_turns(scan_rad / (2 * kPi));
    const double circle = 2 * kPi / from_.azimuth_rad;
    const double bin_m = plan_.sharp.range_bin_m();
    const auto azimuth_at = [&](std::size_t bin) {
      return level_azimuth(scan, std::max(1.0, plan_.sharp.r_min_m + static_cast<double>(bin) * bin_m));
    };
    double next = azimuth_at(0);
    for (std::size_t r = 0; r < n_range; ++r) {
      if (r % kTile == 0) {
        ask(kAzimuth);
        near_ = next;
        next = azimuth_at(r + kTile);
        slope_ = std::remainder(next - near_, circle) / kTile;
      }
      const double azimuth = near_ + slope_ * (static_cast<double>(r % kTile) + 0.5);
      const auto [ground, row] = ground_at(static_cast<int>(std::floor(azimuth)));
      const std::size_t from = row * n_range + r;
      const std::size_t to = static_cast<std::size_t>(a) * n_range + r;
      wedge_->count[to] = ground->count[from];
      wedge_->state[to] = ground->state[from];
      if (!wedge_->returns.empty()) wedge_->returns[to] = ground->returns[from];
    }
  }

  struct GroundRow {
    const SharpWedge* wedge;
    std::size_t row;
  };
  /// Of those that the wedge's scan angles may see, the nearest.
  GroundRow ground_at(int azimuth) const {
    int k = azimuth - first_row_;
    if (from_.rows.wraps) k = ((k % from_.rows.n_rows) + from_.rows.n_rows) % from_.rows.n_rows;
    k = std::clamp(k, 0, static_cast<int>(ready_.rows.size()) - 1);
    const SharpWedge* wedge = ready_.rows[static_cast<std::size_t>(k)];
    return {wedge, static_cast<std::size_t>(azimuth_of(k) - wedge->first_azimuth)};
  }

  const EchoPlan& plan_;
  const GroundAzimuths& from_;
  const EchoRows::Ready& ready_;
  const int first_row_;
  std::shared_ptr<SharpWedge> wedge_;
  const std::size_t stride_;
  std::vector<double> tile_power_, tile_sine_;
  double near_ = 0;
  double slope_ = 0;
};

}  // namespace

SharpWedgePtr turned_wedge(const EchoPlan& plan, const EchoRows::Ready& ground, const SharpPlanes& planes,
                           std::uint64_t look_key) {
  const std::shared_ptr<SharpWedge> wedge = Turning(plan, ground, planes).turned();
  if (planes.look) wedge->draw_look(plan, look_key);
  return wedge;
}

}  // namespace obliq
