#include "libperception/importers/ScanOddities.h"

#include <fmt/format.h>

#include <variant>

#include "libperception/core/Error.h"
#include "libperception/measurement/frames/NoReturns.h"
#include "libperception/measurement/frames/ScanTimes.h"

namespace perception {

std::optional<SensorFrame> ScanOddities::mended(const SensorFrame& frame) {
  const auto* const given = std::get_if<LidarCloud>(&frame.data);
  if (given == nullptr) return {};
  Counts& counts = sensors_[frame.sensor];
  ++counts.scans;
  std::optional<SensorFrame> mended;
  const auto copy = [&]() -> LidarCloud& {
    if (!mended) mended = frame;
    return std::get<LidarCloud>(mended->data);
  };
  const NoReturns none = noReturnsOf(*given);
  counts.elsewhere += none.elsewhere;
  if (!none.points.empty()) counts.no_returns += static_cast<std::int64_t>(clear(none, copy()));
  if (timesOutsideOf(mended ? copy() : *given)) ++counts.timeless, copy().time_offset.clear();
  return mended;
}

void ScanOddities::tell(std::vector<std::string>& notes, std::vector<std::string>& warnings) const {
  for (const auto& [label, counts] : sensors_) {
    if (2 * counts.elsewhere > counts.scans)
      throw DataError(fmt::format(
          "{}: most returns of {} of {} scans lie farther than {:g} m, each elsewhere: their "
          "coordinates are not in meters, or not about the sensor (a map's?)",
          label, counts.elsewhere, counts.scans, kFarthestReturn));
    if (counts.elsewhere > 0)
      warnings.push_back(
          fmt::format("{}: {} of {} scans have most returns farther than {:g} m: left out", label,
                      counts.elsewhere, counts.scans, kFarthestReturn));
    else if (counts.no_returns > 0)
      notes.push_back(
          fmt::format("{}: {} points of {} scans are no returns (farther than {:g} m, or in many "
                      "directions at the same farthest range): left out",
                      label, counts.no_returns, counts.scans, kFarthestReturn));
    if (counts.timeless > 0)
      warnings.push_back(fmt::format(
          "{}: returns lie more than {:g} s outside of {} of its scans: their times are not used",
          label, kLongestScan, counts.timeless));
  }
}

}  // namespace perception
