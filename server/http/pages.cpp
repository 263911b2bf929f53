#include "server/http/pages.h"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

namespace obliq::http {

Page health_page() { return {200, "text/plain; charset=utf-8", "ok\n"}; }

Page readiness_page(const Readiness::State& state) {
  Page page;
  switch (state.phase) {
    case Readiness::Phase::loading: {
      const int percent = static_cast<int>(100 * std::clamp(state.fraction, 0.0, 1.0));
      page.body = fmt::format("loading: {}, {} %\n", state.stage, percent);
      break;
    }
    case Readiness::Phase::ready:
      page.body = "ready\n";
      break;
    case Readiness::Phase::stopping:
      page.body = "stopping\n";
      break;
  }
  page.status = state.phase == Readiness::Phase::ready ? 200 : 503;
  return page;
}

Page metrics_page(std::string text) {
  return {200, "text/plain; version=0.0.4; charset=utf-8", std::move(text)};
}

}  // namespace obliq::http
