#pragma once
#include <string>

#include "terrain/dem/raster.h"

namespace obliq {

/// How far an elevation model is from the truth, as its maker or a survey has found.
struct DemAccuracy {
  std::string product;  ///< what it was taken for
  double rmse_m = 0;    ///< vertical; 0: not known
};

/// By the file's name, its format and its posting.
DemAccuracy dem_accuracy(const Raster& raster);

}  // namespace obliq
