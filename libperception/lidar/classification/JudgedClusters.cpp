#include "libperception/lidar/classification/JudgedClusters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/core/math/LogMath.h"
#include "libperception/lidar/classification/CloudedSurfaces.h"
#include "libperception/lidar/classification/PhantomPrior.h"
#include "libperception/lidar/classification/VehiclePieces.h"
#include "libperception/lidar/classification/ViewEnd.h"
#include "libperception/lidar/outline/BoxFit.h"
#include "libperception/lidar/segments/LooseReturns.h"
#include "libperception/measurement/models/FootprintInView.h"

namespace perception {
namespace {

using Probabilities = PhantomPrior::Probabilities;

/// That of the likeliest road user, of probabilities or of evidence.
template <std::size_t n>
double roadUser(const std::array<double, n>& p) {
  return *std::max_element(p.begin(), p.begin() + kRoadUsers);
}

double at(const Probabilities& p, ClusterKind kind) { return p[static_cast<std::size_t>(kind)]; }

/// Least probability at which a part stands for itself, and that of a whole which is not looked
/// into (assumed).
constexpr double kLeastPart = 0.3, kSureWhole = 0.7;
constexpr double kSureThing = 0.98;  // or a phantom: a whole is not looked into (assumed)
/// Evidence of the likeliest road user below which a cluster is surely none: with one road user
/// in ten clusters, 1 in 66 is one (assumed).
constexpr double kSurelyThing = -2;

/// Probability from which a cluster is surely a phantom, if that of every road user is below the
/// second one (assumed).
constexpr double kSurePhantom = 0.7, kHardlyRoadUser = 0.05;
constexpr double kSuspicious = 0.5;  // P(phantom) above which a kept cluster counts as such
/// Where the air is likely not clear, P(phantom) from which a cluster may be a surface with what is
/// in the air about it (assumed).
constexpr double kNotClear = 0.5, kPerhapsPhantom = 0.2;
/// Least evidence of a road user for a wall in a cloud that stands for it: that of one in ten is
/// .23 (assumed).
constexpr double kRoadUserInCloud = 1;
constexpr float kDoubted = 0.5f;  // trust of a return below which it is doubted

/// Largest road users [m], longer and shorter side, with what returns beside them add: people with
/// a pram, cyclists with a trailer, articulated buses of 2.6 m with their mirrors (assumed).
constexpr float kLargest[kRoadUsers][2] = {{2.5f, 2}, {3.5f, 2}, {20, 3.6f}};

/// Longer than the first [m] vehicles are as high as the second, where the view reaches so far (of
/// 926 clusters on labeled vehicles in seven recordings all are). Lower: a hedge, a wall.
constexpr float kLongAndHigh[][2] = {{5.5f, 1.25f}, {7, 2}};

/// Without the road users that are smaller than the cluster, and without vehicles that are too low
/// for their length: at best its parts are some. `top_of_view` [m] above the ground at the cluster.
Probabilities withinSize(Probabilities p, const Descriptor& d, double top_of_view) {
  const float sides[2] = {d[static_cast<std::size_t>(Feature::kLength)],
                          d[static_cast<std::size_t>(Feature::kWidth)]};
  const float top = d[static_cast<std::size_t>(Feature::kTop)];
  const bool low =
      std::any_of(std::begin(kLongAndHigh), std::end(kLongAndHigh), [&](const float(&bound)[2]) {
        return sides[0] > bound[0] && top < bound[1] && top_of_view > static_cast<double>(bound[1]);
      });
  for (std::size_t k = 0; k < kRoadUsers; ++k) {
    const bool too_low = low && k == static_cast<std::size_t>(ClusterKind::kVehicle);
    if (sides[0] <= kLargest[k][0] && sides[1] <= kLargest[k][1] && !too_low) continue;
    p[static_cast<std::size_t>(ClusterKind::kThing)] += p[k];
    p[k] = 0;
  }
  return p;
}

bool isVehicle(const JudgedCluster& c, double least_evidence) {
  const double vehicle = c.evidence[static_cast<std::size_t>(ClusterKind::kVehicle)];
  return vehicle > least_evidence && vehicle >= roadUser(c.evidence);
}

Vector2 middleOf(const LidarDetections& found, const std::vector<std::uint32_t>& obstacles) {
  Vector2 sum = Vector2::Zero();
  for (const std::uint32_t i : obstacles) sum += Vector2(found.x[i], found.y[i]);
  return sum / static_cast<double>(obstacles.size());
}

/// Drops what lies in the footprint of a likely vehicle: its seats, its roof, what is seen through
/// its windows.
void dropFragments(const LidarDetections& found, std::vector<JudgedCluster>& judged) {
  constexpr double kMargin = 0.3;  // [m] about the box of its returns (assumed)
  constexpr double kPerson = 1;    // evidence by which a person beside it stands (assumed)
  std::vector<Vector2> centers;
  for (const JudgedCluster& j : judged) centers.push_back(middleOf(found, j.points));
  std::vector<char> fragment(judged.size(), 0);
  for (std::size_t v = 0; v < judged.size(); ++v) {
    if (!isVehicle(judged[v], 0)) continue;
    std::vector<Vector2> places;
    for (const std::uint32_t i : judged[v].points) places.emplace_back(found.x[i], found.y[i]);
    double radius2 = 0;
    for (const Vector2& p : places) radius2 = std::max(radius2, (p - centers[v]).squaredNorm());
    // The box reaches no farther from their center along either side; most have nothing near.
    const double reach = std::sqrt(2.0) * (std::sqrt(radius2) + kMargin) + 1e-6;
    std::vector<std::size_t> near;
    for (std::size_t i = 0; i < judged.size(); ++i)
      if (i != v && judged[i].points.size() < judged[v].points.size() &&
          std::max(judged[i].evidence[0], judged[i].evidence[1]) < kPerson &&
          (centers[i] - centers[v]).squaredNorm() <= reach * reach)
        near.push_back(i);
    if (near.empty()) continue;
    const auto box = fitBox(places, found.points.sensor.head<2>(), true, true, BoxParams{});
    if (!box) continue;
    const Vector2 along(std::cos(box->yaw), std::sin(box->yaw));
    for (const std::size_t i : near) {
      const Vector2 d = centers[i] - box->center;
      fragment[i] =
          fragment[i] || (std::abs(d.dot(along)) < box->length / 2 + kMargin &&
                          std::abs(d.dot(perpendicular(along))) < box->width / 2 + kMargin);
    }
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < judged.size(); ++i) {
    if (fragment[i]) continue;
    if (kept != i) judged[kept] = std::move(judged[i]);
    ++kept;
  }
  judged.resize(kept);
}

/// Drops the loose returns of likely vehicles: their plume, their spray.
void dropLoose(const LidarDetections& found, const DirectionCells& cells,
               std::vector<JudgedCluster>& judged) {
  constexpr double kSureVehicle = 2;  // evidence: of one in ten, as likely as not (assumed)
  for (JudgedCluster& j : judged) {
    if (!isVehicle(j, kSureVehicle)) continue;
    std::vector<std::uint32_t> points, kept;
    points.reserve(j.points.size());
    for (const std::uint32_t i : j.points) points.push_back(found.obstacles[i]);
    for (const std::uint32_t k : surfaceReturns(found.points, cells, points))
      kept.push_back(j.points[k]);
    j.points = std::move(kept);
  }
}

PhantomCluster phantomOf(const LidarDetections& found, const std::vector<std::uint32_t>& obstacles,
                         double probability) {
  PhantomCluster phantom;
  phantom.returns = obstacles.size(), phantom.probability = probability;
  phantom.center = middleOf(found, obstacles);
  if (found.trust.empty()) return phantom;
  for (const std::uint32_t i : obstacles)
    if (found.trust[i] < kDoubted)
      phantom.doubted.push_back(found.points.source[found.obstacles[i]]);
  return phantom;
}

/// Probability from which it is one, if none of its parts is a person or a cyclist and two may be
/// vehicles.
constexpr double kLikelyWhole = 0.5, kPerhaps = 0.2;

/// Marks the clusters that stand for themselves.
std::vector<char> standing(const std::vector<DescribedCluster>& clusters) {
  const std::size_t n = clusters.size();
  // The likeliest over all parts of parts; `person`: or a cyclist.
  std::vector<double> person(n, 0), vehicle(n, 0);
  std::vector<int> vehicles(n, 0);     // parts that may be some
  for (std::size_t i = n; i-- > 0;) {  // parts come after their whole
    const int whole = clusters[i].segment.whole;
    if (whole < 0) continue;
    const auto w = static_cast<std::size_t>(whole);
    const Probabilities& p = clusters[i].probabilities;
    person[w] = std::max(
        {person[w], person[i], at(p, ClusterKind::kPedestrian), at(p, ClusterKind::kCyclist)});
    vehicle[w] = std::max({vehicle[w], vehicle[i], at(p, ClusterKind::kVehicle)});
    vehicles[w] += at(p, ClusterKind::kVehicle) >= kPerhaps;
  }
  std::vector<char> stands(n, 0), in_parts(n, 0);  // reached from above; is given as its parts
  for (std::size_t i = 0; i < n; ++i) {
    const int whole = clusters[i].segment.whole;
    const bool reached = whole < 0 || in_parts[static_cast<std::size_t>(whole)];
    const Probabilities& p = clusters[i].probabilities;
    const double own = roadUser(p);
    const bool one_vehicle = at(p, ClusterKind::kVehicle) >= kLikelyWhole &&
                             person[i] < kLeastPart && vehicles[i] > 1 &&
                             holdsOneVehicle(clusters[i].descriptor);
    in_parts[i] = reached && own < kSureWhole && !one_vehicle &&
                  std::max(person[i], vehicle[i]) > std::max(kLeastPart, own);
    stands[i] = reached && !in_parts[i];
  }
  return stands;
}

/// Collects the clusters of a scan that may be road users.
class RoadUserCollector {
 public:
  RoadUserCollector(const LidarDetections& found, const ClusterClassifier& classifier,
                    std::vector<JudgedCluster>& judged)
      : found_(found), classifier_(classifier), prior_(classifier.prior()), judged_(judged) {}

  /// A classifier's probabilities where something may make phantoms.
  Probabilities among(const DescribedCluster& c, const CausesHere& causes) const {
    return prior_(c.probabilities, causes);
  }

  void add(DescribedCluster& described, const Probabilities& p, const CausesHere& causes) {
    JudgedCluster cluster;
    cluster.phantom =
        1 - meanTrust(described.segment.points, found_) * (1 - at(p, ClusterKind::kPhantom));
    cluster.looks_phantom = classifier_.phantomEvidence(described.probabilities);
    cluster.cause = std::max({causes.weather, causes.cloud, causes.spray});
    cluster.evidence = classifier_.evidence(p);
    cluster.known = classifier_.known().weights(described.descriptor, cluster.evidence);
    if (roadUser(cluster.evidence) < kSurelyThing) return;
    cluster.points = std::move(described.segment.points);
    const float isolation = described.descriptor[static_cast<std::size_t>(Feature::kIsolation)];
    cluster.alone = isolation > 0.5f;
    judged_.push_back(std::move(cluster));
  }

  /// Those that are likelier surfaces than phantoms, with at least such evidence of a road user;
  /// whether there is one.
  bool addSurfaces(std::vector<DescribedCluster> surfaces, const CausesHere& causes, double least) {
    bool any = false;
    for (DescribedCluster& surface : surfaces) {
      const Probabilities p = among(surface, causes);
      if (at(p, ClusterKind::kPhantom) > kSuspicious || roadUser(classifier_.evidence(p)) < least)
        continue;
      add(surface, p, causes);
      any = true;
    }
    return any;
  }

 private:
  const LidarDetections& found_;
  const ClusterClassifier& classifier_;
  const PhantomPrior prior_;
  std::vector<JudgedCluster>& judged_;
};

}  // namespace

Judgement judgedClusters(const LidarDetections& found, const LidarCloud& cloud,
                         const DirectionCells& cells, const ClusterClassifier& classifier,
                         const CausesAt& causes_at, double reach) {
  const ViewEnd end(found, cells);
  const auto judge = [&](DescribedCluster& cluster) {
    Probabilities& p = cluster.probabilities;
    p[static_cast<std::size_t>(ClusterKind::kThing)] = 1;
    if (!cluster.described) return false;
    const auto range =
        static_cast<double>(cluster.descriptor[static_cast<std::size_t>(Feature::kRange)]);
    p = withinSize(classifier.probabilities(cluster.descriptor), cluster.descriptor,
                   found.points.sensor.z() + found.top_slope * range);
    end.weigh(cluster);
    return roadUser(p) < kSureWhole &&
           at(p, ClusterKind::kThing) + at(p, ClusterKind::kPhantom) < kSureThing;
  };
  const ClusterDescriber describer(found, cloud, cells);
  auto clusters = describedClusters(found, describer, judge, reach);
  std::vector<char> stands = standing(clusters);
  joinPieces(found, describer, judge, clusters, stands);
  Judgement judgement;
  std::vector<JudgedCluster>& judged = judgement.clusters;
  RoadUserCollector collector(found, classifier, judged);
  judgement.phantom.assign(found.obstacles.size(), PlacedReturns::kNoCluster);
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    if (!stands[i]) continue;
    const bool asks = causes_at && clusters[i].described;
    const CausesHere causes =
        asks ? causes_at(middleOf(found, clusters[i].segment.points)) : CausesHere{};
    DescribedCluster& cluster = clusters[i];
    const Probabilities p = collector.among(cluster, causes);
    const double phantom = at(p, ClusterKind::kPhantom);
    for (const std::uint32_t point : cluster.segment.points)
      judgement.phantom[point] = static_cast<float>(phantom);
    ++judgement.verdicts.clusters;
    const bool sure = phantom > kSurePhantom && roadUser(cluster.probabilities) < kHardlyRoadUser;
    if (sure)
      judgement.verdicts.phantoms.push_back(phantomOf(found, cluster.segment.points, phantom));
    const bool mixed = causes.weather > kNotClear && phantom > kPerhapsPhantom;
    if (mixed && collector.addSurfaces(surfacesIn(cluster.segment.points, found, describer, judge),
                                       causes, kMinusInfinity))
      continue;
    if (std::max(causes.likelier(), causes.spray) > kNotClear && phantom > kPerhapsPhantom &&
        collector.addSurfaces(wallsIn(cluster.segment.points, found, cells, describer, judge),
                              causes, kRoadUserInCloud))
      continue;
    if (!sure) collector.add(cluster, p, causes);
  }
  dropFragments(found, judged);
  dropLoose(found, cells, judged);
  for (JudgedCluster& j : judged)
    for (std::size_t k = 0; k < kRoadUsers; ++k) j.evidence[k] *= j.known[k];
  judgement.verdicts.suspicious = static_cast<std::size_t>(
      std::count_if(judged.begin(), judged.end(),
                    [](const JudgedCluster& c) { return c.phantom > kSuspicious; }));
  return judgement;
}

}  // namespace perception
