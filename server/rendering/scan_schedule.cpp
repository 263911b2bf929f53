#include "server/rendering/scan_schedule.h"

#include <algorithm>

#include "terrain/base/units.h"

namespace obliq::rendering {
namespace {

constexpr double kMostLag_s = 0.25;
constexpr double kMostLagPasses = 0.25;

}  // namespace

ScanSchedule::ScanSchedule(const RadarSettings& settings, Time begin)
    : begin_(begin),
      to_and_fro_(settings.scan_mode == ScanMode::sector),
      azimuth_bins_(settings.azimuth_bins),
      dwell_bins_(settings.scan_dwell_bins),
      dwells_((settings.azimuth_bins + settings.scan_dwell_bins - 1) / settings.scan_dwell_bins),
      bin_s_(settings.sector_deg / settings.azimuth_bins / settings.scan_rate_deg_s),
      pass_s_(settings.sector_deg / settings.scan_rate_deg_s),
      lag_s_(std::min(kMostLag_s, kMostLagPasses * pass_s_)) {}

AzimuthRange ScanSchedule::azimuths(const Dwell& dwell) const {
  const int from_left = is_clockwise(dwell.pass) ? dwell.number : dwells_ - 1 - dwell.number;
  const int first = from_left * dwell_bins_;
  return {first, std::min(dwell_bins_, azimuth_bins_ - first)};
}

ScanSchedule::Time ScanSchedule::pass_begin(std::uint64_t pass) const {
  return begin_ + from_seconds(static_cast<double>(pass) * pass_s_);
}

ScanSchedule::Time ScanSchedule::at(const Dwell& dwell, double share) const {
  const AzimuthRange bins = azimuths(dwell);
  const int passed = is_clockwise(dwell.pass) ? bins.first : azimuth_bins_ - bins.first - bins.count;
  return pass_begin(dwell.pass) + from_seconds((passed + share * bins.count) * bin_s_);
}

Dwell ScanSchedule::after(const Dwell& dwell) const {
  return dwell.number + 1 < dwells_ ? Dwell{dwell.pass, dwell.number + 1} : Dwell{dwell.pass + 1, 0};
}

Dwell ScanSchedule::at(Time now) const {
  const double since_s = std::max(0.0, to_seconds(now - begin_));
  Dwell dwell{static_cast<std::uint64_t>(since_s / pass_s_), 0};
  const double bins = (since_s - static_cast<double>(dwell.pass) * pass_s_) / bin_s_;
  // Going left, the short dwell, if the last is one, comes first.
  const int short_by = dwells_ * dwell_bins_ - azimuth_bins_;
  const double lead = is_clockwise(dwell.pass) ? 0 : short_by;
  dwell.number = std::clamp(static_cast<int>((bins + lead) / dwell_bins_), 0, dwells_ - 1);
  return dwell;
}

Dwell ScanSchedule::next(const Dwell& in_order, Time now) const {
  if (now <= end(in_order) + from_seconds(lag_s_)) return in_order;
  return std::max(in_order, at(now));
}

}  // namespace obliq::rendering
