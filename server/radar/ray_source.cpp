#include "server/radar/ray_source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "server/radar/exact_math.h"

namespace obliq {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whether a ray of this elevation can meet anything of the sector's box between r_min and r_max.
class SwathTest {
 public:
  explicit SwathTest(const FramePlan& plan)
      : below_bottom_m_(plan.box().antenna_above_bottom_m),
        below_top_m_(plan.box().kappa_m),
        r_min_m_(plan.sector().r_min_m),
        r_max_m_(plan.sector().r_max_m) {}

  bool reaches(double sin_elevation) const {
    if (sin_elevation < 0) {
      // The box's ground lies between these ranges along the ray.
      if (below_bottom_m_ < -sin_elevation * r_min_m_) return false;
      return below_top_m_ <= -sin_elevation * r_max_m_;
    }
    return below_top_m_ <= 0 && -below_top_m_ >= sin_elevation * r_min_m_;
  }

 private:
  double below_bottom_m_;
  double below_top_m_;
  double r_min_m_;
  double r_max_m_;
};

/// Symmetric and oblique frusta. The pixels of one azimuth bin in a row are a run of columns, because all
/// directions of a row lie in one line: the run's ends are where that line meets the bin's edges.
class PerspectiveRays : public RaySource {
 public:
  PerspectiveRays(const FramePlan& plan, AzimuthRange range)
      : plan_(plan), camera_(plan.camera()), swath_(plan) {
    if (plan.settings().plates == PlateKind::spread)
      half_pixel_m_ = std::hypot(camera_.pixel_width_m(), camera_.pixel_height_m()) / 2;
    for (int bin = range.first; bin < range.first + range.count; ++bin)
      add_pieces(bin, plan.bins().azimuth_edge_rad(bin), plan.bins().azimuth_edge_rad(bin + 1));
    begin_row();
  }

  bool next(RayBatch& batch) override {
    batch.n = 0;
    for (int pixels = 0; row_ < camera_.rows && !batch.full() && pixels < kMostPixels;) {
      if (run_ == runs_.size()) {
        ++row_;
        begin_row();
        continue;
      }
      Run& run = runs_[run_];
      if (run.from == run.to) {
        ++run_;
        continue;
      }
      const bool backwards = row_ % 2 == 1;
      emit(batch, run.bin, backwards ? --run.to : run.from++);
      ++pixels;
    }
    return batch.n > 0 || row_ < camera_.rows;
  }

 private:
  /// Part of an azimuth bin that stays in front of or behind the antenna.
  struct Piece {
    int bin;
    bool ahead;               // between -90 and 90 degrees
    double tan_from, tan_to;  // of the bearing offsets at its ends; infinite at +-90 degrees
  };
  struct Run {
    int bin;
    int from, to;  // columns [from, to)
  };

  void add_pieces(int bin, double from, double to) {
    double start = from;
    for (const double cut : {-kPi / 2, kPi / 2, kInfinity}) {
      const double end = std::min(cut, to);
      if (end > start) {
        const double middle = (start + end) / 2;
        pieces_.push_back({bin, std::abs(middle) < kPi / 2, tangent(start, true), tangent(end, false)});
        start = end;
      }
      if (cut >= to) break;
    }
  }

  /// Tangent of a bearing offset as the start or the end of a piece. Ahead of the antenna tangents rise from
  /// -infinity to infinity, and so they do on each side behind it.
  static double tangent(double offset, bool start) {
    if (std::abs(std::abs(offset) - kPi / 2) < 1e-12) return start ? -kInfinity : kInfinity;
    const SinCos at = sincos_turns(offset / (2 * kPi));
    return at.sin / at.cos;
  }

  int column_at(double x) const {
    const double column = (x - camera_.left_m) / camera_.pixel_width_m() - 0.5;
    if (!(column > 0)) return 0;
    if (!(column < camera_.columns)) return camera_.columns;
    return static_cast<int>(std::ceil(column));
  }

  void begin_row() {
    runs_.clear();
    run_ = 0;
    if (row_ >= camera_.rows) return;
    direction0_ = camera_.direction(0, row_);
    // A row exactly abeam would divide the plane at +-90 degrees; it is treated as lying a hair ahead.
    if (direction0_.z == 0) direction0_.z = std::numeric_limits<double>::min();
    const double ahead = direction0_.z;
    for (const Piece& piece : pieces_) {
      if (piece.ahead != (ahead > 0)) continue;
      const int a = column_at(ahead * piece.tan_from);
      const int b = column_at(ahead * piece.tan_to);
      const int from = std::min(a, b);
      const int to = std::max(a, b);
      if (from < to) runs_.push_back({piece.bin, from, to});
    }
    if (row_ % 2 == 1) std::reverse(runs_.begin(), runs_.end());
  }

  void emit(RayBatch& batch, int bin, int column) {
    const double x = camera_.column_x_m(column);
    const double y = direction0_.y;
    const double z = direction0_.z;
    const double length2 = x * x + y * y + z * z;
    const double length = std::sqrt(length2);
    // A plate that is spread may reach into the swath from half a pixel outside.
    if (!swath_.reaches(y / length) &&
        !(half_pixel_m_ > 0 && (swath_.reaches(std::max(-1.0, y / (length + half_pixel_m_))) ||
                                swath_.reaches(std::max(-1.0, y / std::max(0.0, length - half_pixel_m_))))))
      return;
    const glm::dvec3 d = plan_.sector().world_from_antenna(x / length, y / length, z / length);
    const auto k = static_cast<std::size_t>(batch.n++);
    batch.dir_x[k] = d.x;
    batch.dir_y[k] = d.y;
    batch.dir_z[k] = d.z;
    // The viewing-plane vector has the same length as (x, y, z).
    batch.solid_angle_sr[k] = camera_.solid_angle_sr(column, row_, length2, length);
    batch.azimuth_bin[k] = bin;
    batch.pixel[k] = static_cast<std::uint32_t>(row_) * static_cast<std::uint32_t>(camera_.columns) +
                     static_cast<std::uint32_t>(column);
  }

  const FramePlan& plan_;
  const PerspectiveFrustum& camera_;
  SwathTest swath_;
  double half_pixel_m_ = 0;  // half a pixel's diagonal in the viewing plane; 0 with nearest plates
  std::vector<Piece> pieces_;
  int row_ = 0;
  glm::dvec3 direction0_{0.0};
  std::vector<Run> runs_;
  std::size_t run_ = 0;
};

/// Polar frustum: columns uniform in azimuth, rows from polar_rows.h.
class PolarRays : public RaySource {
 public:
  PolarRays(const FramePlan& plan, AzimuthRange range) : plan_(plan), swath_(plan) {
    const int columns = plan.settings().pixel_columns;
    const BinGrid& bins = plan.bins();
    const double step = bins.azimuth_width_rad * bins.n_azimuth / columns;
    width_rad_ = step;
    // Column c belongs to bin floor((c + 1/2) n_azimuth / columns), in integers.
    for (int c = 0; c < columns; ++c) {
      const auto bin =
          static_cast<int>((2 * static_cast<std::int64_t>(c) + 1) * bins.n_azimuth / (2 * columns));
      if (bin < range.first || bin >= range.first + range.count) continue;
      const double offset = bins.azimuth_start_rad + (c + 0.5) * step;
      columns_.push_back({c, bin, sincos_turns(offset / (2 * kPi))});
    }
    begin_row();
  }

  bool next(RayBatch& batch) override {
    batch.n = 0;
    const int rows = static_cast<int>(plan_.polar().ray_rad.size());
    while (row_ < rows && !batch.full()) {
      if (!row_reaches_ || at_ == columns_.size()) {
        ++row_;
        begin_row();
        continue;
      }
      emit(batch, columns_[row_ % 2 == 1 ? columns_.size() - 1 - at_ : at_]);
      ++at_;
    }
    return batch.n > 0;
  }

 private:
  struct Column {
    int index;
    int bin;
    SinCos offset;
  };

  void begin_row() {
    at_ = 0;
    const PolarRows& rows = plan_.polar();
    const auto r = static_cast<std::size_t>(row_);
    if (r >= rows.ray_rad.size()) return;
    elevation_ = sincos_turns(rows.ray_rad[r] / (2 * kPi));
    const double low = sincos_turns(rows.edge_rad[r] / (2 * kPi)).sin;
    const double high = sincos_turns(rows.edge_rad[r + 1] / (2 * kPi)).sin;
    solid_angle_sr_ = width_rad_ * (high - low);
    row_reaches_ = swath_.reaches(elevation_.sin) || (plan_.settings().plates == PlateKind::spread &&
                                                      (swath_.reaches(low) || swath_.reaches(high)));
  }

  void emit(RayBatch& batch, const Column& column) {
    const glm::dvec3 d = plan_.sector().world_from_antenna(column.offset.sin * elevation_.cos, elevation_.sin,
                                                           column.offset.cos * elevation_.cos);
    const auto k = static_cast<std::size_t>(batch.n++);
    batch.dir_x[k] = d.x;
    batch.dir_y[k] = d.y;
    batch.dir_z[k] = d.z;
    batch.solid_angle_sr[k] = solid_angle_sr_;
    batch.azimuth_bin[k] = column.bin;
    // Texture rows run from the top (far) down, polar rows from near to far.
    const auto rows = static_cast<int>(plan_.polar().ray_rad.size());
    batch.pixel[k] = static_cast<std::uint32_t>(rows - 1 - row_) *
                         static_cast<std::uint32_t>(plan_.settings().pixel_columns) +
                     static_cast<std::uint32_t>(column.index);
  }

  const FramePlan& plan_;
  SwathTest swath_;
  std::vector<Column> columns_;
  double width_rad_ = 0;
  int row_ = 0;
  std::size_t at_ = 0;
  bool row_reaches_ = false;
  SinCos elevation_{0, 1};
  double solid_angle_sr_ = 0;
};

class NoRays : public RaySource {
 public:
  bool next(RayBatch& batch) override {
    batch.n = 0;
    return false;
  }
};

}  // namespace

std::unique_ptr<RaySource> make_ray_source(const FramePlan& plan, AzimuthRange range) {
  if (!plan.extent().any) return std::make_unique<NoRays>();
  if (plan.settings().frustum == FrustumKind::polar) return std::make_unique<PolarRays>(plan, range);
  return std::make_unique<PerspectiveRays>(plan, range);
}

}  // namespace obliq
