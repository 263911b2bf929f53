// What rasters of gamma say of the scene's ground.
#include <algorithm>
#include <string>
#include <vector>

#include "server/explain/explanation.h"
#include "server/radar/frame_plan.h"
#include "server/radar/simd/lanes/exact_math.h"

namespace obliq {
namespace {

/// Of cells: least, median and greatest, in dB.
struct Spread {
  double share = 0;
  std::vector<double> db{};

  Spread(std::vector<double> linear, double cells) : share(100 * static_cast<double>(linear.size()) / cells) {
    if (linear.empty()) return;
    std::ranges::sort(linear);
    for (const double value : {linear.front(), linear[linear.size() / 2], linear.back()})
      db.push_back(db_of_ratio(value));
  }
  std::string text() const {
    std::string text;
    for (const double value : db) text += (text.empty() ? "" : ", ") + number_text(value, ".1f");
    return text;
  }
};

}  // namespace

std::vector<ReportRow> raster_rows(const FramePlan& plan) {
  const std::vector<float>& cells = plan.scene().world().raster_gamma;
  if (cells.empty()) return {};
  std::vector<double> factors, gammas;
  for (const float cell : cells) {
    if (cell < 0) gammas.push_back(-static_cast<double>(cell));
    if (cell > 0 && cell != 1) factors.push_back(static_cast<double>(cell));
  }
  const auto n = static_cast<double>(cells.size());
  const Spread times(std::move(factors), n), own(std::move(gammas), n);
  return rows_of(values("share"_is = times.share, "factors"_is = times.text(), "own_share"_is = own.share,
                        "gammas"_is = own.text(), "cells"_is = static_cast<std::uint64_t>(cells.size())),
                 {{"gamma raster", true, "Of {cells} ground cells "},
                  {"gamma raster", !times.db.empty(),
                   "{share:.1f} % return their material's power times a raster's: {factors} dB, least, "
                   "median, greatest. "},
                  {"gamma raster", !times.db.empty() && !own.db.empty(), "Of all "},
                  {"gamma raster", !own.db.empty(),
                   "{own_share:.1f} % have a raster's gamma in the material's place: {gammas} dB, least, "
                   "median, greatest. "},
                  {"gamma raster", times.db.empty() && own.db.empty(), "none has a value of a raster. "}});
}

}  // namespace obliq
