#include "libperception/lidar/classification/VehiclePieces.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libperception/lidar/description/DescriptorParts.h"
#include "libperception/lidar/outline/BoxFit.h"

namespace perception {
namespace {

/// Of a vehicle that no second one fits into [m] (assumed).
constexpr float kOneVehicle[2] = {6, 2.5f};
/// Probabilities of a vehicle: from which pieces are tried, from which none is needed (it would
/// only widen what is told from a bus by its size), and that a vehicle with its pieces has at least
/// (assumed).
constexpr double kLikelyVehicle = 0.5, kWithoutPieces = 0.95, kLeastJoined = 0.7;
/// Probabilities from which a cluster is a person or a cyclist, and a thing, and so no piece
/// (assumed).
constexpr double kPerhapsPerson = 0.3, kThingAlone = 0.9;
/// [m] of the boxes of a vehicle and a piece: the longest link of segments.
constexpr auto kMostApart = static_cast<float>(LinkLength{}.most);

double chance(const DescribedCluster& c, ClusterKind kind) {
  return c.probabilities[static_cast<std::size_t>(kind)];
}

bool needsPieces(const DescribedCluster& c) {
  const double vehicle = chance(c, ClusterKind::kVehicle);
  return vehicle >= kLikelyVehicle && vehicle < kWithoutPieces;
}

bool maybePiece(const DescribedCluster& c) {
  return chance(c, ClusterKind::kThing) < kThingAlone &&
         chance(c, ClusterKind::kPedestrian) + chance(c, ClusterKind::kCyclist) < kPerhapsPerson;
}

/// About returns, along the axes of the ego frame [m].
struct ReturnsBox {
  Interval x, y;

  ReturnsBox() = default;
  ReturnsBox(const LidarDetections& found, const DescribedCluster& cluster) {
    for (const std::uint32_t i : cluster.segment.points) x.add(found.x[i]), y.add(found.y[i]);
  }
  float apart(const ReturnsBox& b) const {
    return std::hypot(std::max({x.low - b.x.high, b.x.low - x.high, 0.0f}),
                      std::max({y.low - b.y.high, b.y.low - y.high, 0.0f}));
  }
};

/// Both together, if that is likelier a vehicle than either.
std::optional<DescribedCluster> join(const ClusterDescriber& describer, const ClusterVisitor& judge,
                                     const DescribedCluster& vehicle,
                                     const DescribedCluster& piece) {
  DescribedCluster both;
  both.segment.whole = vehicle.segment.whole;
  const auto &a = vehicle.segment.points, &b = piece.segment.points;
  std::merge(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(both.segment.points));
  both.descriptor = describer.describe(both.segment.points);
  if (!holdsOneVehicle(both.descriptor)) return {};
  judge(both);
  const double joined = chance(both, ClusterKind::kVehicle);
  const bool likelier = joined > std::max(chance(vehicle, ClusterKind::kVehicle),
                                          chance(piece, ClusterKind::kVehicle));
  return likelier && joined >= kLeastJoined ? std::optional(std::move(both)) : std::nullopt;
}

/// [m] Trucks are longer than any van (7.4 m) with what touches it, and high where the view reaches
/// so far; least length of a piece whose direction is theirs (assumed).
constexpr float kTruckLong = 8, kTruckHigh = 2, kLongPiece = 3;
/// [m] by which all together are longer than the one piece at least (assumed).
constexpr float kLonger = 1;
/// Least probability that a piece, and all pieces together, are a vehicle; of two pieces that are
/// both one with the second probability, each is (assumed).
constexpr double kLeastLong = 0.1, kOneItself = 0.7;
constexpr double kPlume =
    0.5;  // probability of a phantom from which a cluster is no piece (assumed)
/// [m] by which the sides of the pieces are off one line, and [-] of the distance along it: the
/// least deviation of a box's direction; [m] that the widest vehicles reach behind their side.
constexpr float kOffSide = 0.3f, kOffDirection = 0.05f, kWidest = 3.2f;

/// The side of a long vehicle that faces the sensor, found from one piece.
class LongSide {
 public:
  /// Empty: the piece has no direction.
  static std::optional<LongSide> of(const LidarDetections& found, const DescribedCluster& piece) {
    std::vector<Vector2> places;
    places.reserve(piece.segment.points.size());
    for (const std::uint32_t i : piece.segment.points)
      places.emplace_back(static_cast<double>(found.x[i]), static_cast<double>(found.y[i]));
    const Vector2 sensor = found.points.sensor.head<2>();
    const auto box = fitBox(places, sensor, true, true, BoxParams{});
    if (!box || box->length < static_cast<double>(kLongPiece)) return {};
    LongSide side;
    side.along_ = {static_cast<float>(std::cos(box->yaw)), static_cast<float>(std::sin(box->yaw))};
    side.across_ = {-side.along_.y(), side.along_.x()};
    if (side.across_.cast<double>().dot(box->center - sensor) < 0) side.across_ *= -1;
    const Bounds own = side.boundsOf(found, piece);
    side.near_ = own.near, side.middle_ = (own.along.low + own.along.high) / 2;
    side.along_it_ = own.along;
    return side;
  }

  /// Whether a cluster continues it, with a side on one line with its own and no more than a link
  /// apart from what there is of it; it is then a part of it.
  bool takes(const LidarDetections& found, const DescribedCluster& piece) {
    const Bounds b = boundsOf(found, piece);
    const float away = std::max({b.along.low - along_it_.high, along_it_.low - b.along.high, 0.0f});
    const float from_middle = std::abs((b.along.low + b.along.high) / 2 - middle_);
    if (away > kMostApart || std::abs(b.near - near_) > kOffSide + kOffDirection * from_middle ||
        b.far > near_ + kWidest)
      return false;
    along_it_.add(b.along.low), along_it_.add(b.along.high);
    return true;
  }

 private:
  struct Bounds {
    Interval along;
    float near, far;
  };
  Bounds boundsOf(const LidarDetections& found, const DescribedCluster& c) const {
    Bounds bounds;
    std::vector<float> off;
    off.reserve(c.segment.points.size());
    for (const std::uint32_t i : c.segment.points) {
      const Eigen::Vector2f p(found.x[i], found.y[i]);
      bounds.along.add(along_.dot(p));
      off.push_back(across_.dot(p));
    }
    bounds.near = quantile(off, 0.02), bounds.far = quantile(off, 0.98);
    return bounds;
  }

  Eigen::Vector2f along_, across_;  ///< across: away from the sensor
  float near_ = 0, middle_ = 0;
  Interval along_it_;
};

/// Gives all of a vehicle the probabilities of its piece, if they make it likelier.
void takeLikelier(const DescribedCluster& piece, DescribedCluster& all) {
  if (chance(piece, ClusterKind::kVehicle) > chance(all, ClusterKind::kVehicle))
    all.probabilities = piece.probabilities;
}

/// Joins to what is high and may be a vehicle all that continues its side, if together they are
/// longer than a car and may be a truck or bus.
void joinLong(const LidarDetections& found, const ClusterDescriber& describer,
              const ClusterVisitor& judge, std::size_t v, std::vector<DescribedCluster>& clusters,
              std::vector<char>& stands) {
  auto side = LongSide::of(found, clusters[v]);
  if (!side) return;
  std::vector<std::size_t> pieces;
  for (bool more = true; more;) {
    more = false;
    for (std::size_t i = 0; i < clusters.size(); ++i) {
      const DescribedCluster& c = clusters[i];
      if (i == v || !stands[i] || !c.described ||
          chance(c, ClusterKind::kPedestrian) + chance(c, ClusterKind::kCyclist) >=
              kPerhapsPerson ||
          chance(c, ClusterKind::kPhantom) >= kPlume ||
          std::find(pieces.begin(), pieces.end(), i) != pieces.end() || !side->takes(found, c))
        continue;
      pieces.push_back(i);
      more = true;
    }
  }
  const auto itself = [&](std::size_t i) {
    return chance(clusters[i], ClusterKind::kVehicle) >= kOneItself;
  };
  if (pieces.empty() ||
      static_cast<int>(itself(v)) + std::count_if(pieces.begin(), pieces.end(), itself) > 1)
    return;
  DescribedCluster all;
  all.segment = clusters[v].segment;
  for (const std::size_t i : pieces) {
    const auto& points = clusters[i].segment.points;
    all.segment.points.insert(all.segment.points.end(), points.begin(), points.end());
  }
  std::sort(all.segment.points.begin(), all.segment.points.end());
  all.descriptor = describer.describe(all.segment.points);
  if (at(all.descriptor, Feature::kLength) <=
      std::max(kTruckLong, at(clusters[v].descriptor, Feature::kLength) + kLonger))
    return;
  judge(all);
  if (chance(all, ClusterKind::kVehicle) < kLeastLong) return;
  // Models have seen few trucks, and pieces of them alone: the whole is as likely one as its
  // likeliest piece.
  for (const std::size_t i : pieces) takeLikelier(clusters[i], all);
  takeLikelier(clusters[v], all);
  clusters[v] = std::move(all);
  for (const std::size_t i : pieces) stands[i] = 0;
}

}  // namespace

bool holdsOneVehicle(const Descriptor& d) {
  return d[static_cast<std::size_t>(Feature::kLength)] <= kOneVehicle[0] &&
         d[static_cast<std::size_t>(Feature::kWidth)] <= kOneVehicle[1];
}

void joinPieces(const LidarDetections& found, const ClusterDescriber& describer,
                const ClusterVisitor& judge, std::vector<DescribedCluster>& clusters,
                std::vector<char>& stands) {
  for (std::size_t i = 0; i < clusters.size(); ++i)
    if (stands[i] && clusters[i].described &&
        chance(clusters[i], ClusterKind::kVehicle) >= kLeastLong &&
        at(clusters[i].descriptor, Feature::kTop) >= kTruckHigh)
      joinLong(found, describer, judge, i, clusters, stands);
  std::vector<std::size_t> vehicles, pieces;
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (!stands[i] || !clusters[i].described || !holdsOneVehicle(clusters[i].descriptor)) continue;
    if (needsPieces(clusters[i])) vehicles.push_back(i);
    if (maybePiece(clusters[i])) pieces.push_back(i);
  }
  if (vehicles.empty()) return;
  std::vector<ReturnsBox> boxes(clusters.size());
  for (const std::size_t i : pieces) boxes[i] = ReturnsBox(found, clusters[i]);
  for (const std::size_t v : vehicles) {
    DescribedCluster& vehicle = clusters[v];
    if (!stands[v]) continue;
    boxes[v] = ReturnsBox(found, vehicle);
    for (const std::size_t i : pieces) {
      if (i == v || !stands[i] || !needsPieces(vehicle) || boxes[v].apart(boxes[i]) > kMostApart)
        continue;
      auto both = join(describer, judge, vehicle, clusters[i]);
      if (!both) continue;
      vehicle = std::move(*both);
      boxes[v] = ReturnsBox(found, vehicle);
      stands[i] = 0;
    }
  }
}

}  // namespace perception
