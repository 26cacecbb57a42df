#include "libperception/lidar/classification/VehiclePieces.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include "libperception/lidar/description/DescriptorParts.h"

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

}  // namespace

bool holdsOneVehicle(const Descriptor& d) {
  return d[static_cast<std::size_t>(Feature::kLength)] <= kOneVehicle[0] &&
         d[static_cast<std::size_t>(Feature::kWidth)] <= kOneVehicle[1];
}

void joinPieces(const LidarDetections& found, const ClusterDescriber& describer,
                const ClusterVisitor& judge, std::vector<DescribedCluster>& clusters,
                std::vector<char>& stands) {
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
