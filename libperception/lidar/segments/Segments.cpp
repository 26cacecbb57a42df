#include "libperception/lidar/segments/Segments.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "libperception/core/math/Angle.h"
#include "libperception/lidar/linkage/SpaceLinkage.h"
#include "libperception/lidar/segments/GrazedSurfaces.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/RawVector.h"

namespace perception {
namespace {

/// Link of each return at the first level's share of 1 [m]; without branches, so that the compiler
/// vectorizes it.
PERCEPTION_WIDER void findLengths(const float* __restrict x, const float* __restrict y,
                                  std::size_t count, const LinkLength link,
                                  double* __restrict length) {
  for (std::size_t i = 0; i < count; ++i) {
    const auto px = static_cast<double>(x[i]), py = static_cast<double>(y[i]);
    // As hypot() of floats, without its call.
    const auto range = static_cast<double>(static_cast<float>(std::sqrt(px * px + py * py)));
    const double sloped = link.at_zero + link.slope * range;
    const double least = sloped < link.least ? link.least : sloped;
    length[i] = link.most < least ? link.most : least;
  }
}

/// The segments of a tree, as far as they are found.
struct Found {
  const SegmentVisitor& visit;
  std::vector<Segment> segments;

  /// Whether its parts are wanted.
  bool add(const ReturnGroup& group, int whole) {
    segments.push_back({group, whole});
    return !visit || visit(segments.back());
  }
};

}  // namespace

class SegmentFinder::Trees {
 public:
  Trees(const std::vector<float>& x, const std::vector<float>& y, const std::vector<float>& height,
        double min_points, double max_size, const std::vector<float>& weight,
        const std::optional<Vector3>& sensor, const LinkLength& link)
      : x_(x),
        y_(y),
        height_(height),
        weight_(weight),
        link_(link),
        min_points_(min_points - 1e-6),
        max_size_(max_size),
        length_(x.size()) {
    findLengths(x.data(), y.data(), x.size(), link, length_.data());
    std::vector<std::uint32_t> all(x_.size());
    std::iota(all.begin(), all.end(), 0u);
    constexpr double kLeastOfColumn = 4;  // returns (assumed)
    const double least = sensor ? std::min(min_points_, kLeastOfColumn - 1e-6) : min_points_;
    groups_ = groupsOf(all, kLinkLevels[0], least);
    if (sensor && !all.empty()) {
      joinSurfaces(*sensor);
    } else {
      for (std::uint32_t g = 0; g < groups_.size(); ++g) trees_.push_back({g});
    }
  }

  std::size_t count() const { return trees_.size(); }

  /// The groups of the first level; surfaces that the distance of their columns has cut into
  /// several are wholes, too.
  std::vector<Segment> find(std::size_t tree, const SegmentVisitor& visit) const {
    const std::vector<std::uint32_t>& members = trees_[tree];
    Found found{visit, {}};
    int whole = -1;
    if (members.size() > 1) {
      const ReturnGroup joined = joinedOf(members);
      if (isEnough(joined) && sizeOf(joined) <= max_size_) {
        whole = 0;
        if (!found.add(joined, -1)) return std::move(found.segments);
      }
    }
    for (const std::uint32_t m : members)
      if (isEnough(groups_[m])) addGroup(groups_[m], whole, 0, found);
    return std::move(found.segments);
  }

 private:
  /// Groups of a segment's returns at a level.
  std::vector<ReturnGroup> groupsOf(const ReturnGroup& members, const LinkLevel& level,
                                    double least_weight) const {
    std::vector<LinkedReturn> returns(members.size());
    const auto vertical = static_cast<float>(level.vertical);
    for (std::size_t k = 0; k < members.size(); ++k) {
      const std::uint32_t i = members[k];
      returns[k] = {x_[i], y_[i], height_[i] * vertical,
                    static_cast<float>(length_[i] * level.share)};
    }
    const Partition linked = linkInSpace(returns, static_cast<float>(link_.least * level.share),
                                         static_cast<float>(link_.most * level.share));
    return largeGroups(members, linked, least_weight);
  }

  /// Those of enough returns; in a snowfall most groups are of a few.
  std::vector<ReturnGroup> largeGroups(const ReturnGroup& members, const Partition& linked,
                                       double least_weight) const {
    std::vector<double> weight(linked.count, 0);
    std::vector<std::uint32_t> size(linked.count, 0);
    std::vector<std::uint32_t*> next(linked.count, nullptr);  // of small ones nowhere
    for (std::size_t k = 0; k < members.size(); ++k) {
      const std::uint32_t g = linked.group[k];
      weight[g] += weight_.empty() ? 1.0 : static_cast<double>(weight_[members[k]]), ++size[g];
    }
    std::vector<ReturnGroup> groups;
    for (std::uint32_t g = 0; g < linked.count; ++g)
      if (!(weight[g] < least_weight)) next[g] = groups.emplace_back(size[g]).data();
    for (std::size_t k = 0; k < members.size(); ++k)
      if (std::uint32_t*& to = next[linked.group[k]]; to != nullptr) *to++ = members[k];
    return groups;
  }

  /// `of_longer`: `members` are longer than any whole.
  void addParts(const ReturnGroup& members, int whole, std::size_t level, Found& found,
                bool of_longer = false) const {
    if (level == std::size(kLinkLevels)) return;
    const auto groups = groupsOf(members, kLinkLevels[level], min_points_);
    if (whole >= 0 && groups.size() < 2) return addParts(members, whole, level + 1, found);
    for (const ReturnGroup& group : groups)
      if (!of_longer || !isCutOut(group, members)) addGroup(group, whole, level, found);
  }

  /// A group of a level, and its parts.
  void addGroup(const ReturnGroup& group, int whole, std::size_t level, Found& found) const {
    if (sizeOf(group) > max_size_) return addParts(group, whole, level + 1, found, true);
    const auto number = static_cast<int>(found.segments.size());
    if (found.add(group, whole)) addParts(group, number, level + 1, found);
  }

  /// Makes trees of groups and of surfaces, each in the place of its first group.
  void joinSurfaces(const Vector3& sensor) {
    const ReturnPlaces places = {x_, y_, height_};
    directions_.emplace(places, sensor);
    step_ = azimuthStep(*directions_, groups_);
    const auto surfaces = grazedSurfaces(places, groups_, sensor, *directions_, step_);
    std::vector<char> placed(groups_.size(), 0);
    std::vector<const std::vector<std::uint32_t>*> surface_of(groups_.size(), nullptr);
    for (const auto& surface : surfaces)
      for (const std::uint32_t g : surface) surface_of[g] = &surface;
    for (std::uint32_t g = 0; g < groups_.size(); ++g) {
      if (placed[g]) continue;
      trees_.push_back(surface_of[g] ? *surface_of[g] : std::vector<std::uint32_t>{g});
      for (const std::uint32_t m : trees_.back()) placed[m] = 1;
    }
  }

  /// The returns of several groups, ascending.
  ReturnGroup joinedOf(const std::vector<std::uint32_t>& members) const {
    ReturnGroup joined;
    for (const std::uint32_t m : members) {
      const auto middle = joined.insert(joined.end(), groups_[m].begin(), groups_[m].end());
      std::inplace_merge(joined.begin(), middle, joined.end());
    }
    return joined;
  }

  /// Whether one beam, or up to three columns of beams, have cut a part out of a surface that goes
  /// on above, below or beside it, so that its place goes along with the sensor.
  bool isCutOut(const ReturnGroup& part, const ReturnGroup& surface) const {
    constexpr double kThin = radians(0.1), kColumns = 0.9;  // [rad], [steps]: rms (assumed)
    constexpr double kNear = 25;  // [m] farther off, one row may be all of a thing (assumed)
    const std::uint32_t one = part.front();
    if (!directions_ || std::hypot(x_[one], y_[one]) > kNear) return false;
    const float first = directions_->azimuth[one];
    const auto turn = [&](std::uint32_t i) {
      return wrapAngle(static_cast<double>(directions_->azimuth[i] - first));
    };
    Vector2 sum = Vector2::Zero();
    Matrix2 squares = Matrix2::Zero();
    double right = 0, left = 0;
    for (const std::uint32_t i : part) {
      const Vector2 direction(turn(i), static_cast<double>(directions_->elevation[i]));
      sum += direction, squares += direction * direction.transpose();
      right = std::min(right, direction.x()), left = std::max(left, direction.x());
    }
    const auto n = static_cast<double>(part.size());
    const Matrix2 covariance = squares / n - sum * sum.transpose() / (n * n);
    if (std::sqrt(covariance(0, 0)) < kColumns * step_) return true;
    const double half = covariance.trace() / 2;
    if (half - std::sqrt(std::max(half * half - covariance.determinant(), 0.0)) >= kThin * kThin)
      return false;
    const auto in_its_columns = std::count_if(surface.begin(), surface.end(), [&](auto i) {
      return turn(i) >= right && turn(i) <= left;
    });
    return 2 * static_cast<std::size_t>(in_its_columns) > 3 * part.size();
  }

  /// Whether its returns weigh `min_points_`.
  bool isEnough(const ReturnGroup& group) const {
    if (weight_.empty()) return static_cast<double>(group.size()) >= min_points_;
    double sum = 0;
    return std::any_of(group.begin(), group.end(), [&](std::uint32_t i) {
      return (sum += static_cast<double>(weight_[i])) >= min_points_;
    });
  }

  /// Longer side of the box about it along the axes [m].
  double sizeOf(const ReturnGroup& members) const {
    float x0 = x_[members[0]], x1 = x0, y0 = y_[members[0]], y1 = y0;
    for (const std::uint32_t i : members) {
      x0 = std::min(x0, x_[i]), x1 = std::max(x1, x_[i]);
      y0 = std::min(y0, y_[i]), y1 = std::max(y1, y_[i]);
    }
    return static_cast<double>(std::max(x1 - x0, y1 - y0));
  }

  const std::vector<float>&x_, &y_, &height_, &weight_;
  const LinkLength link_;
  const double min_points_, max_size_;
  RawVector<double> length_;         ///< [m] link of each return, at the first level's share of 1
  std::vector<ReturnGroup> groups_;  ///< of the first level
  std::vector<std::vector<std::uint32_t>> trees_;  ///< their groups
  std::optional<ReturnDirections> directions_;     ///< with the sensor's place
  double step_ = 0;                                ///< [rad] of azimuth between columns; 0: unknown
};

SegmentFinder::SegmentFinder(const std::vector<float>& x, const std::vector<float>& y,
                             const std::vector<float>& height, double min_points, double max_size,
                             const std::vector<float>& weight, const std::optional<Vector3>& sensor,
                             const LinkLength& link)
    : trees_(std::make_unique<const Trees>(x, y, height, min_points, max_size, weight, sensor,
                                           link)) {}

SegmentFinder::~SegmentFinder() = default;

std::size_t SegmentFinder::trees() const { return trees_->count(); }

std::vector<Segment> SegmentFinder::find(std::size_t tree, const SegmentVisitor& visit) const {
  return trees_->find(tree, visit);
}

}  // namespace perception
