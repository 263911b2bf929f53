#include "server/radar/rays/polar_rays.h"

#include <algorithm>
#include <array>
#include <numbers>

#include "terrain/base/asking.h"

namespace obliq {
namespace {
constexpr int kRun = 1024;    // columns between two times that are asked
constexpr int kAColumn = 10;  // in units of ask()
}  // namespace

std::vector<PolarColumn> polar_columns(const FramePlan& plan, AzimuthRange range) {
  const std::int64_t columns = plan.settings().pixel_columns;
  const BinGrid& bins = plan.bins();
  const double step_rad = bins.azimuth_width_rad * bins.n_azimuth / static_cast<double>(columns);
  std::vector<PolarColumn> found;
  // floor((c + 1/2) n_azimuth / columns), in integers: no column before the bin's share has its centre in it.
  for (std::int64_t c = range.first * columns / bins.n_azimuth; c < columns; ++c) {
    const auto bin = static_cast<int>((2 * c + 1) * bins.n_azimuth / (2 * columns));
    if (bin < range.first) continue;
    if (bin >= range.first + range.count) break;
    if (found.size() % kRun == 0) ask(kAColumn * kRun);
    const double offset_rad = bins.azimuth_start_rad + (static_cast<double>(c) + 0.5) * step_rad;
    found.push_back({static_cast<int>(c), bin, sincos_turns(offset_rad / (2 * std::numbers::pi))});
  }
  return found;
}

PolarRays::PolarRays(const FramePlan& plan, AzimuthRange range)
    : plan_(plan),
      swath_(swath_test(plan.box(), plan.sector())),
      columns_(polar_columns(plan, range)),
      width_rad_(plan.bins().azimuth_width_rad * plan.bins().n_azimuth / plan.settings().pixel_columns) {}

bool PolarRays::generate(RayBatch& batch) {
  batch.n = 0;
  const std::size_t rows = plan_.polar().ray.size();
  while (row_ < rows && !batch.full()) {
    if (taken_ == 0 && row_ % kSquare == 0 && kSquare * columns_.size() <= kBatch) {
      if (!add_rows(batch)) break;
      continue;
    }
    // Rows too long for squares.
    Row row;
    const auto room = static_cast<std::size_t>(kBatch - batch.n);
    const std::size_t to = std::min(columns_.size(), taken_ + room);
    if (begin_row(row, row_)) {
      for (std::size_t k = 0; k < to - taken_; ++k)
        batch.packet_order[static_cast<std::size_t>(batch.n) + k] =
            static_cast<std::uint16_t>(static_cast<std::size_t>(batch.n) + k);
      add_row(batch, row, taken_, to, row_ % 2 == 1);
      taken_ = to;
    } else {
      taken_ = columns_.size();
    }
    if (taken_ == columns_.size()) {
      ++row_;
      taken_ = 0;
    }
  }
  return batch.n > 0;
}

/// Adds the next rows, whose packets are squares; false when there is no room for them.
bool PolarRays::add_rows(RayBatch& batch) {
  std::array<Row, kSquare> rows;
  std::array<PixelSpan, kSquare> spans;
  const std::size_t end = std::min(row_ + kSquare, plan_.polar().ray.size());
  for (std::size_t row = row_; row < end; ++row)
    if (begin_row(rows[row - row_], row)) spans[row - row_] = {0, static_cast<int>(columns_.size())};
  const PixelRows pixels(static_cast<int>(row_), spans);
  if (batch.n + pixels.size() > kBatch) return false;
  const int first = batch.n;
  auto at = static_cast<std::size_t>(first);
  pixels.by_squares([&](int n) { batch.packet_order[at++] = static_cast<std::uint16_t>(first + n); });
  for (std::size_t row = row_; row < end; ++row)
    if (spans[row - row_].to > 0) add_row(batch, rows[row - row_], 0, columns_.size(), row % 2 == 1);
  row_ = end;
  return true;
}

/// True when the row's rays reach the swath.
bool PolarRays::begin_row(Row& row, std::size_t number) const {
  const PolarRows& rows = plan_.polar();
  row.elevation = rows.ray[number];
  const double low = rows.edge[number].sin;
  const double high = rows.edge[number + 1].sin;
  row.solid_angle_sr = width_rad_ * (high - low);
  // Texture rows run from the top (far) down, polar rows from near to far.
  row.first_pixel = static_cast<std::uint32_t>(rows.ray.size() - 1 - number) *
                    static_cast<std::uint32_t>(plan_.settings().pixel_columns);
  return swath_.reaches(row.elevation.sin) ||
         (plan_.settings().plates == PlateKind::spread && (swath_.reaches(low) || swath_.reaches(high)));
}

/// Columns [from, to), counted from the row's own end.
void PolarRays::add_row(RayBatch& batch, const Row& row, std::size_t from, std::size_t to,
                        bool backwards) const {
  const Sector& sector = plan_.sector();
  for (std::size_t n = from; n < to; ++n) {
    const PolarColumn& column = columns_[backwards ? columns_.size() - 1 - n : n];
    const glm::dvec3 d = sector.world_from_antenna(column.offset.sin * row.elevation.cos, row.elevation.sin,
                                                   column.offset.cos * row.elevation.cos);
    const auto k = static_cast<std::size_t>(batch.n++);
    batch.dir_x[k] = d.x;
    batch.dir_y[k] = d.y;
    batch.dir_z[k] = d.z;
    batch.solid_angle_sr[k] = row.solid_angle_sr;
    batch.azimuth_bin[k] = column.azimuth_bin;
    batch.pixel[k] = row.first_pixel + static_cast<std::uint32_t>(column.index);
  }
}

}  // namespace obliq
