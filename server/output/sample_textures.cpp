#include "server/output/sample_textures.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>

#include <array>
#include <cmath>
#include <vector>

#include "server/scene/exact_hit.h"
#include "terrain/base/errors.h"

namespace obliq {
namespace {

enum Channel { range, residual, azimuth, incidence, nx, ny, nz, px, py, pz, n_channels };
constexpr std::array<const char*, n_channels> kNames = {
    "range_m",  "range_residual_m", "azimuth_rad", "incidence_rad", "normal.x",
    "normal.y", "normal.z",         "position.x",  "position.y",    "position.z"};
constexpr std::uint32_t kNoHit = 0xffffffffu;

}  // namespace

struct SampleTextures::Planes {
  int columns;
  int rows;
  std::array<std::vector<float>, n_channels> values;
  std::vector<std::uint32_t> material;
};

SampleTextures::SampleTextures(int columns, int rows) : planes_(new Planes{columns, rows, {}, {}}) {
  const std::size_t n = static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
  for (auto& plane : planes_->values) plane.assign(n, 0.0f);
  planes_->material.assign(n, kNoHit);
}

SampleTextures::~SampleTextures() = default;

void SampleTextures::on_hit(std::uint32_t pixel, double azimuth_offset_rad, const ExactHit& hit) {
  auto& v = planes_->values;
  const auto as_float = [](double x) { return static_cast<float>(x); };
  v[range][pixel] = as_float(hit.slant_range_m);
  v[residual][pixel] = as_float(hit.slant_range_m - static_cast<double>(as_float(hit.slant_range_m)));
  v[azimuth][pixel] = as_float(azimuth_offset_rad);
  v[incidence][pixel] = as_float(std::acos(hit.cos_incidence));
  v[nx][pixel] = as_float(hit.normal.x);
  v[ny][pixel] = as_float(hit.normal.y);
  v[nz][pixel] = as_float(hit.normal.z);
  v[px][pixel] = as_float(hit.position_m.x);
  v[py][pixel] = as_float(hit.position_m.y);
  v[pz][pixel] = as_float(hit.position_m.z);
  planes_->material[pixel] = hit.material;
}

void SampleTextures::write(const std::filesystem::path& path) const {
  try {
    Imf::Header header(planes_->columns, planes_->rows);
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer buffer;
    const auto add = [&](const char* name, Imf::PixelType type, const void* data) {
      header.channels().insert(name, Imf::Channel(type));
      // OpenEXR's output interface wants a pointer to non-const char but only reads through it.
      auto* bytes = const_cast<char*>(static_cast<const char*>(data));
      buffer.insert(name, Imf::Slice(type, bytes, 4, 4 * static_cast<std::size_t>(planes_->columns)));
    };
    for (std::size_t k = 0; k < n_channels; ++k) add(kNames[k], Imf::FLOAT, planes_->values[k].data());
    add("material", Imf::UINT, planes_->material.data());
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(buffer);
    file.writePixels(planes_->rows);
  } catch (const std::exception& error) {
    throw InputError(path.string() + ": cannot be written (" + error.what() + ")");
  }
}

}  // namespace obliq
