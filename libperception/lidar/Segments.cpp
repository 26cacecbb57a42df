#include "libperception/lidar/Segments.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "libperception/lidar/SpaceLinkage.h"

namespace perception {
namespace {

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
    const Partition linked = linkInSpace(returns, static_cast<float>(link_.least * level.share),
                                         static_cast<float>(link_.most * level.share));
    return largeGroups(members, linked);
  }

  /// Those of enough returns; in a snowfall most groups are of a few.
  std::vector<std::vector<std::uint32_t>> largeGroups(const std::vector<std::uint32_t>& members,
                                                      const Partition& linked) const {
    constexpr std::uint32_t kSmall = ~0u;
    std::vector<double> weight(linked.count, 0);
    std::vector<std::uint32_t> size(linked.count, 0), number(linked.count, kSmall);
    for (std::size_t k = 0; k < members.size(); ++k) {
      const std::uint32_t g = linked.group[k];
      weight[g] += weight_.empty() ? 1.0 : static_cast<double>(weight_[members[k]]), ++size[g];
    }
    std::vector<std::vector<std::uint32_t>> groups;
    for (std::uint32_t g = 0; g < linked.count; ++g) {
      if (weight[g] < min_points_) continue;
      number[g] = static_cast<std::uint32_t>(groups.size());
      groups.emplace_back().reserve(size[g]);
    }
    for (std::size_t k = 0; k < members.size(); ++k)
      if (const std::uint32_t n = number[linked.group[k]]; n != kSmall)
        groups[n].push_back(members[k]);
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
