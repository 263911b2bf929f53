#include "terrain/dem_window.h"

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "terrain/gdal_messages.h"
#include "terrain/stage_clock.h"

namespace obliq {
namespace {

constexpr double kVoid = std::numeric_limits<double>::quiet_NaN();
constexpr double kInternationalFoot_m = 0.3048;    // exact, 1959 agreement
constexpr double kSurveyFoot_m = 1200.0 / 3937.0;  // exact, Mendenhall order of 1893
constexpr double kLowestGround_m = -9000;          // -32768 and its like without a nodata tag
constexpr double kHighestGround_m = 100000;        // 999999 and its like, also when read as feet

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
      {"ft", kInternationalFoot_m},
      {"foot", kInternationalFoot_m},
      {"feet", kInternationalFoot_m},
      {"international foot", kInternationalFoot_m},
      {"international feet", kInternationalFoot_m},
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

/// Turns one stored value into metres or a void.
class Decoder {
 public:
  Decoder(const Raster& raster, double metres_per_unit) : metres_(metres_per_unit) {
    GDALRasterBand& band = raster.band();
    int has = 0;
    const double nodata = band.GetNoDataValue(&has);
    if (has) nodata_ = nodata;
    single_ = band.GetRasterDataType() == GDT_Float32;
    const double scale = band.GetScale(&has);
    if (has) scale_ = scale;
    const double offset = band.GetOffset(&has);
    if (has) offset_ = offset;
    if (!std::isfinite(scale_) || scale_ == 0 || !std::isfinite(offset_)) {
      raster.refuse("its band has a scale of " + std::to_string(scale_) + " and an offset of " +
                        std::to_string(offset_),
                    "finite numbers and a scale other than 0");
    }
  }

  double height_m(double stored) const {
    if (!std::isfinite(stored) || stored == nodata_) return kVoid;
    // A nodata tag is text, often with fewer digits than the float it means.
    if (single_ && static_cast<float>(stored) == static_cast<float>(nodata_)) return kVoid;
    const double height_m = (stored * scale_ + offset_) * metres_;
    return height_m >= kLowestGround_m && height_m <= kHighestGround_m ? height_m : kVoid;
  }

 private:
  double metres_;
  double nodata_ = kVoid;
  double scale_ = 1;
  double offset_ = 0;
  bool single_ = false;
};

/// GDAL's raw drivers read past the end of a short file as zeros, and take a short GridFloat file, whose
/// header names no type, for one of bytes: compare the size with what it must hold.
void require_whole_raw_file(const Raster& raster) {
  GDALDataset* dataset = raster.band().GetDataset();
  const char* driver = dataset->GetDriverName();
  if (std::string(driver) != "EHdr" && std::string(driver) != "ENVI") return;
  const std::string extension = lower(CPLGetExtension(raster.path().c_str()));
  if (extension == "flt" && raster.band().GetRasterDataType() != GDT_Float32) {
    raster.refuse("it is truncated: a GridFloat file holds 4 bytes a post", "a whole file");
  }
  VSIStatBufL status;
  if (VSIStatL(raster.path().c_str(), &status) != 0) return;
  const double needed = static_cast<double>(raster.columns()) * raster.rows() * dataset->GetRasterCount() *
                        GDALGetDataTypeSizeBits(raster.band().GetRasterDataType()) / 8;
  if (static_cast<double>(status.st_size) < needed) {
    raster.refuse("it is truncated: " + std::to_string(status.st_size) + " of " +
                      std::to_string(static_cast<long long>(needed)) + " bytes",
                  "a whole file");
  }
}

/// Reads whole rows of a window; a row is never returned unless GDAL read all of it.
class StripReader {
 public:
  explicit StripReader(const Raster& raster) : raster_(raster) {
    const int flags = raster.band().GetMaskFlags();
    if ((flags & (GMF_ALL_VALID | GMF_NODATA)) == 0) mask_ = raster.band().GetMaskBand();
  }

  void read(const PixelRect& rect, std::vector<double>& stored) {
    GdalMessages messages;
    const std::size_t n = static_cast<std::size_t>(rect.columns()) * static_cast<std::size_t>(rect.rows());
    stored.resize(n);
    bool ok = io(raster_.band(), rect, stored.data(), GDT_Float64);
    if (ok && mask_) {
      valid_.resize(n);
      ok = io(*mask_, rect, valid_.data(), GDT_Byte);
      for (std::size_t i = 0; ok && i < n; ++i) {
        if (valid_[i] == 0) stored[i] = kVoid;
      }
    }
    if (!ok || !messages.failure().empty()) {
      raster_.refuse("rows " + std::to_string(rect.row0) + " to " + std::to_string(rect.row1 - 1) +
                         " cannot be read: " + messages.reason("the file is damaged or cut short"),
                     "a whole, readable raster");
    }
  }

 private:
  static bool io(GDALRasterBand& band, const PixelRect& r, void* to, GDALDataType type) {
    return band.RasterIO(GF_Read, r.column0, r.row0, r.columns(), r.rows(), to, r.columns(), r.rows(), type,
                         0, 0, nullptr) == CE_None;
  }

  const Raster& raster_;
  GDALRasterBand* mask_ = nullptr;
  std::vector<unsigned char> valid_;
};

}  // namespace

double metres_per_unit(const Raster& raster, const std::optional<VerticalUnit>& unit) {
  if (unit) {
    return *unit == VerticalUnit::metre  ? 1.0
           : *unit == VerticalUnit::foot ? kInternationalFoot_m
                                         : kSurveyFoot_m;
  }
  const std::string name = raster.band().GetUnitType();
  if (name.empty()) {
    const OGRSpatialReference* crs = raster.band().GetDataset()->GetSpatialRef();
    if (crs && (crs->IsCompound() || crs->IsVertical())) {
      const double metres = crs->GetTargetLinearUnits("COMPD_CS|VERT_CS");
      if (std::isfinite(metres) && metres > 0) return metres;
    }
    return 1;
  }
  const double metres = metres_of(name);
  if (metres == 0) {
    raster.refuse("its heights are in \"" + name + "\"",
                  "metres or feet, or name the true unit in [terrain] unit");
  }
  return metres;
}

double DemWindow::height_at_m(double column, double row, bool between_posts_only) const {
  if (!(column >= -0.5 && row >= -0.5 && column <= raster_columns - 0.5 && row <= raster_rows - 0.5)) {
    return kVoid;
  }
  const double u = std::clamp((column - column0) / step, 0.0, static_cast<double>(nx - 1));
  const double v = std::clamp((row - row0) / step, 0.0, static_cast<double>(nz - 1));
  if (between_posts_only && (u != (column - column0) / step || v != (row - row0) / step)) return kVoid;
  const int c = std::min(static_cast<int>(u), std::max(0, nx - 2));
  const int r = std::min(static_cast<int>(v), std::max(0, nz - 2));
  const double s = u - c;
  const double t = v - r;
  const float* post = height_m.data() + static_cast<std::size_t>(r) * static_cast<std::size_t>(nx) + c;
  const std::size_t right = nx > 1 ? 1 : 0;
  const std::size_t below = nz > 1 ? static_cast<std::size_t>(nx) : 0;
  // A void post must not spoil a place that lies exactly on a line of known ones: 0 x NaN is NaN.
  const auto mix = [](double a, double b, double share) {
    return share == 0 ? a : share == 1 ? b : a + share * (b - a);
  };
  return mix(mix(static_cast<double>(post[0]), static_cast<double>(post[right]), s),
             mix(static_cast<double>(post[below]), static_cast<double>(post[below + right]), s), t);
}

DemWindow::Share DemWindow::share_at(double column, double row) const {
  // Places half-way between the posts of two files must belong to one of them whatever the rounding.
  constexpr double kOwned = 0.501;
  Share share;
  const double u = (column - column0) / step;
  const double v = (row - row0) / step;
  if (!(u > -1 && v > -1 && u < nx && v < nz)) return share;
  const int c0 = static_cast<int>(std::floor(u));
  const int r0 = static_cast<int>(std::floor(v));
  double sum = 0;
  for (int r = std::max(0, r0); r <= std::min(nz - 1, r0 + 1); ++r) {
    for (int c = std::max(0, c0); c <= std::min(nx - 1, c0 + 1); ++c) {
      const double post_m = static_cast<double>(
          height_m[static_cast<std::size_t>(r) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(c)]);
      if (std::isnan(post_m)) continue;
      const double du = std::abs(u - c);
      const double dv = std::abs(v - r);
      share.weight += (1 - du) * (1 - dv);
      sum += (1 - du) * (1 - dv) * post_m;
      share.owned = share.owned || (du <= kOwned && dv <= kOwned);
    }
  }
  if (share.weight > 0) share.height_m = sum / share.weight;
  return share;
}

DemWindow read_window(const Raster& raster, const PixelRect& rect, int step,
                      const std::optional<VerticalUnit>& unit, const Progress& progress, PostSample* sample) {
  const StageProbe probe(Stage::load);
  const Decoder decoder(raster, metres_per_unit(raster, unit));
  require_whole_raw_file(raster);
  DemWindow window;
  window.step = std::max(1, std::min({step, rect.columns(), rect.rows()}));
  window.nx = rect.columns() / window.step;
  window.nz = rect.rows() / window.step;
  window.column0 = rect.column0 + (window.step - 1) / 2.0;
  window.row0 = rect.row0 + (window.step - 1) / 2.0;
  window.raster_columns = raster.columns();
  window.raster_rows = raster.rows();
  window.height_m.resize(static_cast<std::size_t>(window.nx) * static_cast<std::size_t>(window.nz));

  StripReader reader(raster);
  std::vector<double> stored;
  const int strip_posts = std::max(1, 256 / window.step);
  const int used_columns = window.nx * window.step;
  for (int r0 = 0; r0 < window.nz; r0 += strip_posts) {
    const int r1 = std::min(window.nz, r0 + strip_posts);
    const PixelRect strip{rect.column0, rect.row0 + r0 * window.step, rect.column0 + used_columns,
                          rect.row0 + r1 * window.step};
    reader.read(strip, stored);
    if (sample) {
      sample->take(strip, [&](int row, int column) {
        return decoder.height_m(
            stored[static_cast<std::size_t>(row) * static_cast<std::size_t>(used_columns) +
                   static_cast<std::size_t>(column)]);
      });
    }
    for (int r = r0; r < r1; ++r) {
      for (int c = 0; c < window.nx; ++c) {
        double sum = 0;
        int known = 0;
        for (int k = 0; k < window.step; ++k) {
          const std::size_t line = static_cast<std::size_t>((r - r0) * window.step + k);
          const double* at = stored.data() + line * static_cast<std::size_t>(used_columns) +
                             static_cast<std::size_t>(c) * static_cast<std::size_t>(window.step);
          for (int m = 0; m < window.step; ++m) {
            const double height_m = decoder.height_m(at[m]);
            if (std::isnan(height_m)) continue;
            sum += height_m;
            ++known;
          }
        }
        const bool enough = 2 * known >= window.step * window.step;
        window.height_m[static_cast<std::size_t>(r) * static_cast<std::size_t>(window.nx) +
                        static_cast<std::size_t>(c)] = static_cast<float>(enough ? sum / known : kVoid);
      }
    }
    if (progress) progress("elevation", static_cast<double>(r1) / window.nz);
  }
  return window;
}

}  // namespace obliq
