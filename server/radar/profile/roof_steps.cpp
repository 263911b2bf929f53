#include "server/radar/profile/roof_steps.h"

#include <algorithm>

#include "server/scene/exact_hit.h"

namespace obliq {

std::vector<RoofStep> disjoint_roofs(const Buildings& buildings, std::vector<FootprintSpan>& spans) {
  std::vector<RoofStep> steps;
  const auto add = [&](double near_m, double far_m, const FootprintSpan& span) {
    steps.push_back({near_m, far_m, span.roof_y_m,
                     static_cast<double>(buildings.list[span.building].base_y_m), span.building,
                     span.near_m == near_m ? span.wall : kNoFace});
  };
  if (spans.size() == 1 && spans[0].near_m < spans[0].far_m) add(spans[0].near_m, spans[0].far_m, spans[0]);
  if (spans.size() < 2) return steps;
  std::vector<double> edges;
  for (const FootprintSpan& span : spans) {
    edges.push_back(span.near_m);
    edges.push_back(span.far_m);
  }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  std::sort(spans.begin(), spans.end(), [](const FootprintSpan& a, const FootprintSpan& b) {
    if (a.near_m != b.near_m) return a.near_m < b.near_m;
    return a.roof_y_m != b.roof_y_m ? a.roof_y_m < b.roof_y_m : a.wall < b.wall;
  });
  std::size_t next = 0;
  std::vector<FootprintSpan> active;
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    while (next < spans.size() && spans[next].near_m <= edges[e]) active.push_back(spans[next++]);
    std::erase_if(active, [&](const FootprintSpan& span) { return span.far_m <= edges[e]; });
    const FootprintSpan* highest = nullptr;
    for (const FootprintSpan& span : active)
      if (!highest || span.roof_y_m > highest->roof_y_m) highest = &span;
    if (highest) add(edges[e], edges[e + 1], *highest);
  }
  return steps;
}

}  // namespace obliq
