#include "server/radar/beam/seen_rows.h"

#include <utility>

#include "server/radar/beam/turned_wedge.h"

namespace obliq {

SeenRows::SeenRows(const EchoPlan& plan, const RowWindow& window, std::vector<int> outputs,
                   const SharpPlanes& planes, std::uint64_t look_key)
    : plan_(plan), planes_(planes), look_key_(look_key), rows_(window, std::move(outputs)) {
  if (plan.ground) ground_.emplace(plan.ground->rows, rows_.sharp_wedges());
}

void SeenRows::take(int wedge, SharpWedgePtr sharp) {
  if (!ground_) {
    rows_.take(wedge, std::move(sharp));
    return;
  }
  ground_->take(wedge, std::move(sharp));
  for (EchoRows::Ready ready; ground_->next_ready(ready);)
    rows_.take(ready.wedge, turned_wedge(plan_, ready, planes_, look_key_));
}

}  // namespace obliq
