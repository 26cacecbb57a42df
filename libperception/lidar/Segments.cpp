#include "libperception/lidar/Segments.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "libperception/lidar/SpaceLinkage.h"

namespace perception {
namespace {

/// Returns of every group, ascending.
std::vector<std::vector<std::uint32_t>> membersOf(const Partition& groups) {
  std::vector<std::vector<std::uint32_t>> members(groups.count);
  for (std::size_t i = 0; i < groups.group.size(); ++i)
    members[groups.group[i]].push_back(static_cast<std::uint32_t>(i));
  return members;
}

class SegmentFinder {
 public:
  SegmentFinder(const std::vector<float>& x, const std::vector<float>& y,
                const std::vector<float>& height, double min_points, double max_size,
                const std::vector<float>& weight, const SegmentVisitor& visit,
                const LinkLength& link)
      : x_(x),
        y_(y),
        height_(height),
        weight_(weight),
        visit_(visit),
        link_(link),
        min_points_(min_points - 1e-6),
        max_size_(max_size) {}

  std::vector<Segment> find() {
    std::vector<std::uint32_t> all(x_.size());
    std::iota(all.begin(), all.end(), 0u);
    addParts(all, -1, 0);
    return std::move(segments_);
  }

 private:
  /// Groups of a segment's returns at a level.
  std::vector<std::vector<std::uint32_t>> groupsOf(const std::vector<std::uint32_t>& members,
                                                   const LinkLevel& level) const {
    std::vector<LinkedReturn> returns;
    returns.reserve(members.size());
    for (const std::uint32_t i : members) {
      const double range = std::hypot(x_[i], y_[i]);
      const double length =
          std::clamp(link_.at_zero + link_.slope * range, link_.least, link_.most) * level.share;
      returns.push_back({x_[i], y_[i], height_[i] * static_cast<float>(level.vertical),
                         static_cast<float>(length)});
    }
    auto groups = membersOf(linkInSpace(returns, static_cast<float>(link_.least * level.share),
                                        static_cast<float>(link_.most * level.share)));
    for (auto& group : groups)
      for (std::uint32_t& i : group) i = members[i];
    groups.erase(std::remove_if(groups.begin(), groups.end(),
                                [&](const auto& g) { return weightOf(g) < min_points_; }),
                 groups.end());
    return groups;
  }

  void addParts(const std::vector<std::uint32_t>& members, int whole, std::size_t level) {
    if (level == std::size(kLinkLevels)) return;
    auto groups = groupsOf(members, kLinkLevels[level]);
    if (whole >= 0 && groups.size() < 2) return addParts(members, whole, level + 1);
    for (auto& group : groups) {
      if (sizeOf(group) > max_size_) {
        addParts(group, whole, level + 1);
        continue;
      }
      const auto number = static_cast<int>(segments_.size());
      segments_.push_back({group, whole});
      if (!visit_ || visit_(segments_.back())) addParts(group, number, level + 1);
    }
  }

  double weightOf(const std::vector<std::uint32_t>& members) const {
    if (weight_.empty()) return static_cast<double>(members.size());
    double sum = 0;
    for (const std::uint32_t i : members) sum += static_cast<double>(weight_[i]);
    return sum;
  }

  /// Longer side of the box about it along the axes [m].
  double sizeOf(const std::vector<std::uint32_t>& members) const {
    float x0 = x_[members[0]], x1 = x0, y0 = y_[members[0]], y1 = y0;
    for (const std::uint32_t i : members) {
      x0 = std::min(x0, x_[i]), x1 = std::max(x1, x_[i]);
      y0 = std::min(y0, y_[i]), y1 = std::max(y1, y_[i]);
    }
    return static_cast<double>(std::max(x1 - x0, y1 - y0));
  }

  const std::vector<float>&x_, &y_, &height_, &weight_;
  const SegmentVisitor& visit_;
  const LinkLength& link_;
  const double min_points_, max_size_;
  std::vector<Segment> segments_;
};

}  // namespace

std::vector<Segment> findSegments(const std::vector<float>& x, const std::vector<float>& y,
                                  const std::vector<float>& height, double min_points,
                                  double max_size, const std::vector<float>& weight,
                                  const SegmentVisitor& visit, const LinkLength& link) {
  return SegmentFinder(x, y, height, min_points, max_size, weight, visit, link).find();
}

}  // namespace perception
