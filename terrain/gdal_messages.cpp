#include "terrain/gdal_messages.h"

#include <cpl_error.h>
#include <gdal.h>

#include <algorithm>
#include <mutex>

namespace obliq {
namespace {

// Called from inside GDAL: nothing may be thrown through it.
void CPL_STDCALL on_message(CPLErr severity, CPLErrorNum, const char* message) {
  if (severity < CE_Failure) return;
  static_cast<GdalMessages*>(CPLGetErrorHandlerUserData())->keep(message);
}

}  // namespace

GdalMessages::GdalMessages() {
  static std::once_flag registered;
  std::call_once(registered, [] { GDALAllRegister(); });
  CPLPushErrorHandlerEx(on_message, this);
}

GdalMessages::~GdalMessages() { CPLPopErrorHandler(); }

void GdalMessages::keep(const char* message) {
  if (!failure_.empty()) return;
  try {
    failure_ = message;
    std::replace(failure_.begin(), failure_.end(), '\n', ' ');
  } catch (...) {
    failure_.clear();  // out of memory while reporting: the caller has its own wording
  }
}

}  // namespace obliq
