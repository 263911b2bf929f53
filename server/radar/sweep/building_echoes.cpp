// What the sub-columns of an azimuth bin saw of its buildings, as echoes.
#include <algorithm>
#include <span>

#include "server/radar/simd/kernels.h"
#include "server/radar/sweep/building_view.h"
#include "terrain/base/asking.h"

namespace obliq {

/// What several calls saw of a face in a bin is one echo.
void BuildingView::join_echoes() {
  const std::span all(echoes_.echo, static_cast<std::size_t>(echoes_.n));
  std::ranges::sort(all, [](const PartEchoes::Echo& p, const PartEchoes::Echo& q) {
    return p.edge != q.edge ? p.edge < q.edge : p.bin < q.bin;
  });
  int n = 0;
  for (const PartEchoes::Echo& echo : all) {
    PartEchoes::Echo* const last = n > 0 ? &echoes_.echo[n - 1] : nullptr;
    if (last != nullptr && echo.edge == last->edge && echo.bin == last->bin) {
      last->solid_angle_sr += echo.solid_angle_sr;
      last->tangent_sr += echo.tangent_sr;
    } else {
      echoes_.echo[n++] = echo;
    }
  }
  echoes_.n = n;
}

void BuildingView::add_echoes(const Part& part, const ConvexShape& shape, EchoCells& cells) {
  plan_.seen().mark(part.building);
  for (const PartEchoes::Echo& echo : std::span(echoes_.echo, static_cast<std::size_t>(echoes_.n))) {
    const int k = pieces_.n++;
    const bool roof = echo.edge == PartEchoes::kRoof;
    const auto e = static_cast<std::size_t>(roof ? 0 : echo.edge);
    pieces_.solid_angle_sr[k] = echo.solid_angle_sr;
    pieces_.range_m[k] = echo.range_m;
    pieces_.middle_m[k] = echo.middle_m;
    pieces_.tangent_sr[k] = echo.tangent_sr;
    pieces_.roof_m[k] = shape.roof_m;
    pieces_.base_m[k] = shape.base_m;
    pieces_.right0_m[k] = roof ? 0 : shape.right_m[e];
    pieces_.ahead0_m[k] = roof ? 0 : shape.ahead_m[e];
    pieces_.right1_m[k] = roof ? 0 : shape.right_m[e + 1];
    pieces_.ahead1_m[k] = roof ? 0 : shape.ahead_m[e + 1];
    whose_[k] = {echo.bin, part.building, roof ? part.roof_face : corners_[part.first + e].face,
                 part.material, part.one_of_several};
    if (pieces_.n == FacePieces::kMost) put_faces(cells);
  }
}

/// Gives what was seen to `cells`, or keeps what other parts of the building may show of the same face.
void BuildingView::put_faces(EchoCells& cells) {
  const glm::dvec3& antenna = plan_.sector().antenna_m;
  active_kernels().face_places({antenna.x, antenna.y, antenna.z, centre_}, pieces_);
  for (int k = 0; k < pieces_.n; ++k) {
    const Piece& of = whose_[k];
    const FaceEcho face{of.range_bin,
                        of.building,
                        of.face,
                        of.material,
                        static_cast<double>(pieces_.solid_angle_sr[k]),
                        static_cast<double>(pieces_.range_m[k]),
                        pieces_.sec2[k],
                        {pieces_.x_m[k], pieces_.y_m[k], pieces_.z_m[k]}};
    if (of.one_of_several) {
      of_parts_.push_back(face);
    } else {
      cells.add(profile_, face);
    }
  }
  pieces_.n = 0;
}

/// A face that several parts of a building share is one scatterer.
void BuildingView::add_parts_together(EchoCells& cells) {
  std::ranges::stable_sort(of_parts_, [](const FaceEcho& p, const FaceEcho& q) {
    ask(2);
    return p.face != q.face ? p.face < q.face : p.range_bin < q.range_bin;
  });
  for (std::size_t k = 0; k < of_parts_.size();) {
    FaceEcho sum = of_parts_[k];
    for (++k;
         k < of_parts_.size() && of_parts_[k].face == sum.face && of_parts_[k].range_bin == sum.range_bin;
         ++k)
      sum.solid_angle_sr += of_parts_[k].solid_angle_sr;
    cells.add(profile_, sum);
  }
}

}  // namespace obliq
