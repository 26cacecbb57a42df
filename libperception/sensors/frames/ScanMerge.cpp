#include "libperception/sensors/frames/ScanMerge.h"

#include <algorithm>

namespace perception {

namespace {

/// Appends `from`, or `count` times `missing` if the scan lacks the array. `kept`: former number of
/// points, for arrays that earlier scans lacked.
template <class Number>
void append(std::vector<Number>& to, const std::vector<Number>& from, std::size_t kept,
            std::size_t count, Number missing) {
  if (to.empty() && from.empty()) return;
  to.resize(kept, missing);
  to.insert(to.end(), from.begin(), from.end());
  to.resize(kept + count, missing);
}

}  // namespace

void ScanParams::visit(ParamVisitor& v) {
  v.words(
      "merge", merge,
      "labels of the scanners that form one sensor, trailing * as wildcard; empty: its own label");
  v.real("merge_window", merge_window, {0, 1}, "s",
         "from the first scan to the last one of a merged frame; at most [run] reorder_window");
  v.choiceOf("ground", ground, {"false", "true", "only"},
             "the ground plane is estimated from its returns, for all sensors; only: that "
             "and no measurements, whether or not the sensor is in use");
}

bool ScanParams::merges(const std::string& label) const {
  return std::any_of(merge.begin(), merge.end(), [&](const std::string& pattern) {
    if (pattern.empty() || pattern.back() != '*') return pattern == label;
    return label.compare(0, pattern.size() - 1, pattern, 0, pattern.size() - 1) == 0;
  });
}

SensorFrame mergedScan(const std::vector<SensorFrame>& frames, const std::string& label) {
  SensorFrame merged = frames.front();
  merged.sensor = label;
  for (const SensorFrame& frame : frames) merged.stamp = std::max(merged.stamp, frame.stamp);
  LidarCloud all;
  std::uint16_t next_ring = 0;
  const bool timed = std::any_of(frames.begin(), frames.end(), [&](const SensorFrame& frame) {
    return frame.stamp != merged.stamp || !std::get<LidarCloud>(frame.data).time_offset.empty();
  });
  for (const SensorFrame& frame : frames) {
    const auto& cloud = std::get<LidarCloud>(frame.data);
    const std::size_t kept = all.size(), count = cloud.size();
    const Eigen::Isometry3f T = (merged.T_ego_sensor.inverse() * frame.T_ego_sensor).cast<float>();
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3f p = T * Eigen::Vector3f(cloud.x[i], cloud.y[i], cloud.z[i]);
      all.x.push_back(p.x()), all.y.push_back(p.y()), all.z.push_back(p.z());
    }
    append(all.intensity, cloud.intensity, kept, count, 0.F);
    append(all.echo, cloud.echo, kept, count, std::uint8_t{0});
    append(all.pulse_width, cloud.pulse_width, kept, count, 0.F);
    append(all.label, cloud.label, kept, count, static_cast<std::uint8_t>(PointLabel::kUnknown));
    append(all.trust, cloud.trust, kept, count, 1.F);
    // Ring numbers and time offsets are shifted by scanner.
    std::uint16_t highest = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint16_t ring = cloud.ring.empty() ? std::uint16_t{0} : cloud.ring[i];
      highest = std::max(highest, ring);
      all.ring.push_back(static_cast<std::uint16_t>(next_ring + ring));
      if (!timed) continue;
      const float own = cloud.time_offset.empty() ? 0.F : cloud.time_offset[i];
      all.time_offset.push_back(own + static_cast<float>(frame.stamp - merged.stamp));
    }
    next_ring = static_cast<std::uint16_t>(next_ring + highest + 1);
    all.max_range = std::max(all.max_range, cloud.max_range);
  }
  merged.data = std::move(all);
  return merged;
}

}  // namespace perception
