#pragma once
#include <deque>

#include "server/radar/profile/local_sight.h"
#include "server/radar/rays/plates/column_buildings.h"
#include "server/radar/rays/plates/plate.h"

namespace obliq {

/// Plates of the polar frustum.
class ColumnPlates : public PlateSource {
 public:
  explicit ColumnPlates(const FramePlan& plan);
  int spread(const RayBatch& rays, const HitBatch& hits, int first, SampleBatch& samples,
             std::vector<Sample>& waiting) override;
  void finish(std::vector<Sample>& waiting) override;

 private:
  struct Pixel {
    int row = -2;
    bool hit = false;
    Sample nearest;
    SightPoint point;
    Plate plate;
  };
  struct Column {
    bool begun = false;
    int azimuth_bin = 0;
    double sin_bearing = 0;
    double cos_bearing = 1;
    std::vector<RoofSpan> roofs;  // in the column's own plane
    ColumnBuildings buildings;
    Pixel last;  // the newest row's; it is complete when the next row's has come
  };

  void take(const RayBatch& rays, const HitBatch& hits, std::size_t k, std::vector<Sample>& samples);
  Column& column(const RayBatch& rays, std::size_t k);
  void fill_between(const Column& column, Pixel& below, Pixel& above, double edge_slope);
  void walk_between(const SightPoint& from, const SightPoint& to, double to_d_m, double weight,
                    double edge_slope, Plate& below, Plate& above);
  void share_out(const SurfaceSegment& segment, double weight, double edge_slope, Plate& below,
                 Plate& above) const;
  void close_upwards(Column& column, std::vector<Sample>& samples);
  void close(Column& column, std::vector<Sample>& samples);

  const FramePlan& plan_;
  int rows_;
  std::vector<double> edge_slope_;  // [rows + 1], tangents of the rows' edges
  LocalSurface surface_;
  std::deque<Column> columns_;
  int first_column_ = 0;
  Pixel next_;  // its buffers go round
  std::vector<SurfaceSegment> visible_;
  std::vector<SubColumn> sub_columns_;
  std::vector<RoofSpan> sub_column_roofs_;
};

}  // namespace obliq
