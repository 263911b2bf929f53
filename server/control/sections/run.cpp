#include "server/control/sections/run.h"

#include <array>
#include <cmath>

#include "server/control/sections/section.h"

namespace obliq {
namespace {

using Accuracy = RowsOf<Change::reload, &SceneConfig::accuracy>;
constexpr std::array kAccuracyRows{
    Accuracy::row<&AccuracyWish::max_power_error_db>(
        "accuracy.max_power_error_db", "dB", from(0.0001),
        "Largest allowed median error of a bin's power. [accuracy] chooses the frustum's pixels, "
        "even where the scene names some, and \"auto\" cells; kind and plates stay."),
    Accuracy::row<&AccuracyWish::max_gap_fraction>(
        "accuracy.max_gap_fraction", closed(0, 1),
        "Largest allowed fraction of lit bins without a return; 1: any; 0.05 where only "
        "max_power_error_db is given."),
};

void choose_gap_fraction(SceneReading& scene, SectionReader& reader) {
  AccuracyWish& wish = scene.config.accuracy;
  if (reader.table().find("max_gap_fraction") == nullptr && std::isfinite(wish.max_power_error_db))
    wish.max_gap_fraction = AccuracyWish::kUsualGapFraction;
}

constexpr std::array kRayMethods{Choice{"march"}, Choice{"embree"}};  // as in RayMethod

using Run = RowsOf<Change::restart>;
constexpr std::array kRunRows{
    Run::row<&SceneConfig::threads>("run.threads", closed(0, 1024),
                                    "Number of rendering threads; 0: one per core."),
    Run::row<&SceneConfig::rays>(
        "run.rays", kRayMethods,
        "How rays find the ground: march its cells and use Embree only for rays near buildings, or "
        "use Embree for all, which takes longer. The bits are the same except where a ray meets an "
        "edge within rounding."),
};

}  // namespace

const Section kAccuracySection{"accuracy", {kAccuracyRows}, choose_gap_fraction};
const Section kRunSection{"run", {kRunRows}};

}  // namespace obliq
