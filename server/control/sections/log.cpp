#include "server/control/sections/log.h"

#include <array>

#include "server/control/sections/section.h"

namespace obliq {
namespace {

// The lists follow their enumerations.
constexpr std::array kFormats{Choice{"text"}, Choice{"json"}};
constexpr std::array kLevels{Choice{"debug"}, Choice{"info"}, Choice{"warning"}, Choice{"error"}};

using Log = RowsOf<Change::reload, &SceneConfig::log>;
constexpr std::array kRows{
    Log::row<&LogConfig::format>("log.format", kFormats, "Log lines as text or as JSON objects."),
    Log::row<&LogConfig::level>("log.level", kLevels, "Lowest level that is logged."),
};

}  // namespace

const Section kLogSection{"log", {kRows}, nullptr, true};

}  // namespace obliq
