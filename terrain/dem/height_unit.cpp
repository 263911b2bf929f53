#include "terrain/dem/height_unit.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>

#include "terrain/base/units.h"

namespace obliq {
namespace {

constexpr double kSurveyFoot_m = 1200.0 / 3937.0;  // exact, Mendenhall order of 1893

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) {
    return c == '_' || c == '-' ? ' ' : static_cast<char>(std::tolower(c));
  });
  const std::size_t first = text.find_first_not_of(' ');
  if (first == std::string::npos) return {};
  return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

/// Metres of a named unit; 0 when the name is not known.
double metres_of(const std::string& name) {
  static const std::map<std::string, double> known = {
      {"", 1},
      {"m", 1},
      {"metre", 1},
      {"metres", 1},
      {"meter", 1},
      {"meters", 1},
      {"unknown", 1},
      {"none", 1},
      {"cm", 0.01},
      {"centimetre", 0.01},
      {"centimeter", 0.01},
      {"dm", 0.1},
      {"decimetre", 0.1},
      {"decimeter", 0.1},
      {"mm", 0.001},
      {"millimetre", 0.001},
      {"millimeter", 0.001},
      {"km", 1000},
      {"kilometre", 1000},
      {"kilometer", 1000},
      {"ft", kFoot_m},
      {"foot", kFoot_m},
      {"feet", kFoot_m},
      {"international foot", kFoot_m},
      {"international feet", kFoot_m},
      {"us ft", kSurveyFoot_m},
      {"ftus", kSurveyFoot_m},
      {"ft us", kSurveyFoot_m},
      {"foot us", kSurveyFoot_m},
      {"us foot", kSurveyFoot_m},
      {"us feet", kSurveyFoot_m},
      {"us survey foot", kSurveyFoot_m},
      {"us survey feet", kSurveyFoot_m},
      {"survey foot", kSurveyFoot_m},
      {"survey feet", kSurveyFoot_m},
      {"sft", kSurveyFoot_m},
  };
  const auto found = known.find(lower(name));
  return found == known.end() ? 0 : found->second;
}

/// What drivers write where the file names no unit.
bool says_nothing(const std::string& name) {
  const std::string known = lower(name);
  return known.empty() || known == "unknown" || known == "none";
}

}  // namespace

HeightUnit height_unit(const Raster& raster, const std::optional<VerticalUnit>& unit) {
  if (unit == VerticalUnit::metre) return {1, "m", false};
  if (unit == VerticalUnit::foot) return {kFoot_m, "ft", false};
  if (unit == VerticalUnit::us_survey_foot) return {kSurveyFoot_m, "us_ft", false};
  const std::string name = raster.band().GetUnitType();
  if (name.empty()) {
    const OGRSpatialReference* crs = raster.band().GetDataset()->GetSpatialRef();
    if (crs && (crs->IsCompound() || crs->IsVertical())) {
      const char* of_crs = nullptr;
      const double metres = crs->GetTargetLinearUnits("COMPD_CS|VERT_CS", &of_crs);
      if (std::isfinite(metres) && metres > 0) return {metres, of_crs ? of_crs : "", false};
    }
    return {1, "m", true};
  }
  const double metres = metres_of(name);
  if (metres == 0)
    raster.refuse("its heights are in \"" + name + "\"",
                  "metres or feet, or name the true unit in [terrain] unit");
  return {metres, says_nothing(name) ? "m" : name, says_nothing(name)};
}

}  // namespace obliq
