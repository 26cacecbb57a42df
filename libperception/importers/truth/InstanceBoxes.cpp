#include "libperception/importers/truth/InstanceBoxes.h"

#include <algorithm>
#include <cmath>

namespace perception {
namespace {

constexpr double kDirection = 2 * kPi / SeenOutline::kDirections;  // [rad]
constexpr std::size_t kLeastSeen = 5;                              // returns of a row (assumed)
constexpr double kCourseWay = 1;  // [m] of the mean of the returns, that tells a heading (assumed)

const std::array<Vector2, SeenOutline::kDirections>& directions() {
  static const auto all = [] {
    std::array<Vector2, SeenOutline::kDirections> axes;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const double angle = kDirection * static_cast<double>(i);
      axes[i] = {std::cos(angle), std::sin(angle)};
    }
    return axes;
  }();
  return all;
}

/// Middle of the object's interval along an axis: the seen side stays where it was seen.
double middleOf(double low, double high, double extent, double sensor) {
  if (sensor < low) return low + extent / 2;
  if (sensor > high) return high - extent / 2;
  return (low + high) / 2;
}

}  // namespace

std::array<float, SeenOutline::kDirections> SeenOutline::filled() {
  std::array<float, kDirections> all{};
  all.fill(-std::numeric_limits<float>::infinity());
  return all;
}

void SeenOutline::add(const Vector3& point) {
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double along = point.head<2>().dot(directions()[i]);
    reach_[i] = std::max(reach_[i], static_cast<float>(along));
  }
  sum_ += point.head<2>();
  bottom_ = std::min(bottom_, point.z()), top_ = std::max(top_, point.z());
  ++points_;
}

void SeenOutline::add(const SeenOutline& other) {
  for (std::size_t i = 0; i < kDirections; ++i) reach_[i] = std::max(reach_[i], other.reach_[i]);
  sum_ += other.sum_;
  bottom_ = std::min(bottom_, other.bottom_), top_ = std::max(top_, other.top_);
  points_ += other.points_;
}

double SeenOutline::reach(double angle) const {
  const double turns = angle / (2 * kPi);
  const auto at = std::llround((turns - std::floor(turns)) * kDirections);
  return static_cast<double>(reach_[static_cast<std::size_t>(at) % kDirections]);
}

double SeenOutline::longSide() const {
  double best = 0, least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < kDirections / 4; ++i) {
    const double angle = kDirection * static_cast<double>(i);
    const double along = widthAlong(angle), across = widthAlong(angle + kPi / 2);
    if (along * across >= least) continue;
    least = along * across;
    best = along >= across ? angle : angle + kPi / 2;
  }
  return best;
}

void InstanceBoxes::add(std::int64_t id, bool moves, const std::string& type, std::int64_t frame,
                        Stamp stamp, const Vector2& sensor, const Vector3& world) {
  Instance& instance = instances_[id];
  instance.moves = moves, instance.type = type;
  Sighting& sighting = instance.sightings[frame];
  sighting.stamp = stamp, sighting.sensor = sensor;
  sighting.outline.add(world);
}

/// Of each sighting: the direction in which the mean of the returns went over a meter; where it did
/// not, that before; of what stands one for all.
std::vector<double> InstanceBoxes::headingsOf(const Instance& instance) {
  SeenOutline all;
  std::vector<Vector2> means;
  for (const auto& row : instance.sightings) {
    all.add(row.second.outline);
    means.push_back(row.second.outline.mean());
  }
  std::vector<double> headings(means.size(), all.longSide());
  if (!instance.moves) return headings;
  bool known = false;
  std::size_t from = 0;
  for (std::size_t i = 0; i < means.size(); ++i) {
    while (from + 1 < i && (means[i] - means[from + 1]).norm() >= kCourseWay) ++from;
    const Vector2 way = means[i] - means[from];
    if (way.norm() < kCourseWay) {
      if (known) headings[i] = headings[i - 1];
      continue;
    }
    headings[i] = std::atan2(way.y(), way.x());
    if (!known)
      std::fill(headings.begin(), headings.begin() + static_cast<std::ptrdiff_t>(i), headings[i]);
    known = true;
  }
  return headings;
}

std::vector<InstanceBoxes::Row> InstanceBoxes::rows() const {
  std::vector<Row> rows;
  for (const auto& [id, instance] : instances_) {
    const std::vector<double> headings = headingsOf(instance);
    SeenOutline all;
    double length = 0, width = 0, height = 0;
    std::size_t k = 0;
    for (const auto& row : instance.sightings) {
      const SeenOutline& outline = row.second.outline;
      all.add(outline);
      length = std::max(length, outline.widthAlong(headings[k]));
      width = std::max(width, outline.widthAlong(headings[k] + kPi / 2));
      height = std::max(height, outline.top() - outline.bottom());
      ++k;
    }
    k = 0;
    for (const auto& [frame, sighting] : instance.sightings) {
      const double heading = headings[k++];
      if (sighting.outline.points() < kLeastSeen) continue;
      const SeenOutline& outline = instance.moves ? sighting.outline : all;
      const Vector2 ahead(std::cos(heading), std::sin(heading)), left(-ahead.y(), ahead.x());
      TruthObject o;
      o.frame = frame, o.id = id, o.type = instance.type;
      o.yaw = heading;
      o.length = instance.moves ? length : all.widthAlong(heading);
      o.width = instance.moves ? width : all.widthAlong(heading + kPi / 2);
      o.height = instance.moves ? height : all.top() - all.bottom();
      const double along = middleOf(-outline.reach(heading + kPi), outline.reach(heading), o.length,
                                    sighting.sensor.dot(ahead));
      const double across =
          middleOf(-outline.reach(heading - kPi / 2), outline.reach(heading + kPi / 2), o.width,
                   sighting.sensor.dot(left));
      const Vector2 center = along * ahead + across * left;
      o.position = {center.x(), center.y(), outline.bottom()};
      if (!instance.moves) o.vx = o.vy = 0;
      o.lidar_points = static_cast<int>(sighting.outline.points());
      rows.push_back({sighting.stamp, std::move(o)});
    }
  }
  return rows;
}

}  // namespace perception
