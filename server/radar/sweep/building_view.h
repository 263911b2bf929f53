#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <span>
#include <vector>

#include "server/radar/echo/echo_cells.h"
#include "server/radar/scene_plan.h"
#include "server/radar/simd/buildings/face_places.h"
#include "server/radar/simd/buildings/light_left.h"
#include "server/radar/simd/buildings/sub_columns.h"
#include "server/radar/sweep/corner_view.h"
#include "server/radar/sweep/near_view.h"
#include "terrain/base/asking.h"

namespace obliq {

/// The buildings of one azimuth bin as its sub-columns see them, one after the other by distance, and what
/// they leave of the light of its planes' ground. A sub-column is narrower than a building: its horizon of
/// buildings is one slope. There are more of them farther out, where the bin is wider.
class BuildingView {
 public:
  static constexpr int kMostNodesABin = 16;  ///< of a plane's profile, five floats each

  /// far_m: buildings that begin beyond it are left out.
  BuildingView(const ScenePlan& plan, const NearBuildings& near, const ScatteringTable& scattering,
               double far_m);

  /// All buildings of an azimuth bin; `profile`: its place in the wedge. False: no building is near it.
  bool see(int azimuth_bin, int profile, EchoCells& cells);

  /// Those of the bin seen last that a plane may cross, by their numbers; `position`: 0 to 1 across the bin.
  void across(double position, std::vector<std::uint32_t>& buildings) const {
    const auto tangent = static_cast<float>(std::tan((position - 0.5) * plan_.bins().azimuth_width_rad));
    ask(static_cast<std::int64_t>(buildings_.size() + parts_.size()));
    buildings.clear();
    std::ranges::copy_if(buildings_, std::back_inserter(buildings), [&](auto b) { return near_.has(b); });
    for (const Part& part : parts_)
      if (part.from <= tangent && tangent <= part.to) buildings.push_back(part.building);
    std::ranges::sort(buildings);
    buildings.erase(std::unique(buildings.begin(), buildings.end()), buildings.end());
  }

  /// Writes the share of the light of a plane's ground that buildings leave in the bin seen last to
  /// kept[bin * 8], which are 1, and marks in `cells` the range bins in which they leave none.
  void kept_shares(int plane, float* kept, EchoCells& cells);

 private:
  struct Corner {
    float right_m, ahead_m, tangent;
    std::uint32_t face;  // of the wall from here to the next corner; kNoFace: an inner edge
  };
  struct Part {
    float near_m;
    std::uint32_t building;
    std::uint32_t roof_face;
    float roof_m, base_m;  // above the antenna
    float highest;         // slope that it may have
    std::uint8_t material;
    bool one_of_several;
    std::uint32_t first, n;  // into corners_
    float from, to;          // tangents
  };
  void start(int azimuth_bin, int profile);
  void see_near(int azimuth_bin, EchoCells& cells);
  const Part& by_distance(std::size_t k) const { return parts_[static_cast<std::uint32_t>(order_[k])]; }
  SinCos bearing(double position) const;
  void set_out(SinCos centre);
  void ask_for_buildings(std::size_t from) const;
  void ask_for_faces(std::size_t from) const;
  void collect(std::uint32_t building);
  void add_corner(const glm::vec2& corner, std::uint32_t face);
  void add_part(std::uint32_t building, bool one_of_several, std::size_t first_corner);
  void clip(std::size_t first_corner);
  void see(const Part& part, const ConvexShape& shape, EchoCells& cells);
  void fill_shape(const Part& part, ConvexShape& shape) const;
  void refine(float near_m);
  void set_fineness(int n);
  /// Before the part hides anything.
  void see_corners(const Part& part, const ConvexShape& shape) {
    const CornerView::Columns columns{columns_, centre_};
    for (auto walls = corner_view_.square_walls(columns, shape, part.near_m, part.from, part.to); walls != 0;
         walls &= walls - 1) {
      const auto e = static_cast<std::uint32_t>(std::countr_zero(walls));
      corner_view_.see(columns, shape, static_cast<int>(e),
                       {part.building, part.material, corners_[part.first + e].face});
    }
  }
  void join_echoes();
  void add_echoes(const Part& part, const ConvexShape& shape, EchoCells& cells);
  void put_faces(EchoCells& cells);
  void add_parts_together(EchoCells& cells);

  const ScenePlan& plan_;
  const NearBuildings& near_;
  CornerView corner_view_;
  NearView near_view_;
  double far_m_;
  int planes_;
  int least_n_;
  int most_n_;
  int profile_ = 0;
  SinCos centre_{};
  float half_ = 0;  // tangent of half the bin
  double lowest_slope_;
  std::span<const std::uint32_t> buildings_;
  std::vector<Corner> corners_, clipped_;
  std::vector<Part> parts_;
  std::vector<std::uint64_t> order_;  // of parts_: by distance, then as loaded
  SubColumns columns_{};
  std::vector<float> horizon_, clearance_, range_bin_, hidden_, sine_;  // [planes][stride]
  std::vector<double> visible_up_to_, hidden_up_to_;                    // LightLeft's
  std::vector<float> left_;
  std::vector<float> roofs_, shades_, coarser_, per_plane_;
  ConvexShape shapes_[2]{};  // of this part and the next
  PartEchoes echoes_{};
  /// Whose the pieces are.
  struct Piece {
    int range_bin;
    std::uint32_t building, face;
    std::uint8_t material;
    bool one_of_several;
  };
  FacePieces pieces_{};
  Piece whose_[FacePieces::kMost];
  std::vector<FaceEcho> of_parts_;  // of buildings that have several
};

}  // namespace obliq
