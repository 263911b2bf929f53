#include "server/rendering/render_events.h"

namespace obliq::net {

LiveView LiveView::at(std::int64_t now_ns) const {
  LiveView view = *this;
  if (!poses) return view;
  const PoseAt at = poses->at(now_ns);
  view.pose = at.pose;
  view.pose_received_ns = at.received_ns;
  view.pose_stale = at.stale;
  return view;
}

}  // namespace obliq::net
