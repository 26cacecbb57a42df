#include "libperception/lidar/JudgedClusters.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "libperception/lidar/BoxFit.h"
#include "libperception/lidar/LooseReturns.h"
#include "libperception/lidar/PhantomMix.h"
#include "libperception/measurement/FootprintInView.h"

namespace perception {
namespace {

using Probabilities = PhantomMix::Probabilities;

/// Probability of the likeliest road user.
double roadUser(const Probabilities& p) {
  return *std::max_element(p.begin(), p.begin() + kRoadUsers);
}

double at(const Probabilities& p, ClusterKind kind) { return p[static_cast<std::size_t>(kind)]; }

double roadUserEvidence(const JudgedCluster& c) {
  return *std::max_element(c.evidence.begin(), c.evidence.begin() + kRoadUsers);
}

/// Least probability at which a part stands for itself, and that of a whole which is not looked
/// into (assumed).
constexpr double kLeastPart = 0.3, kSureWhole = 0.7;
/// Probability of a thing or a phantom from which a whole is not looked into (assumed).
constexpr double kSureThing = 0.98;
/// Evidence of the likeliest road user below which a cluster is surely none: with one road user
/// in ten clusters, 1 in 66 is one (assumed).
constexpr double kSurelyThing = -2;

/// Probability from which a cluster is surely a phantom, if that of every road user is below the
/// second one (assumed).
constexpr double kSurePhantom = 0.7, kHardlyRoadUser = 0.05;
/// P(phantom) above which a cluster that is kept counts as suspicious: more likely one than not.
constexpr double kSuspicious = 0.5;
constexpr float kDoubted = 0.5f;  // trust of a return below which it is doubted

/// Largest road users [m], longer and shorter side, with what returns beside them add: people with
/// a pram, cyclists with a trailer, articulated buses of 2.6 m with their mirrors (assumed).
constexpr float kLargest[kRoadUsers][2] = {{2.5f, 2}, {3.5f, 2}, {20, 3.6f}};

/// Without the road users that are smaller than the cluster: at best its parts are some.
Probabilities withinSize(Probabilities p, const Descriptor& d) {
  const float sides[2] = {d[static_cast<std::size_t>(Feature::kLength)],
                          d[static_cast<std::size_t>(Feature::kWidth)]};
  for (std::size_t k = 0; k < kRoadUsers; ++k) {
    if (sides[0] <= kLargest[k][0] && sides[1] <= kLargest[k][1]) continue;
    p[static_cast<std::size_t>(ClusterKind::kThing)] += p[k];
    p[k] = 0;
  }
  return p;
}

bool isVehicle(const JudgedCluster& c, double least_evidence) {
  const double vehicle = c.evidence[static_cast<std::size_t>(ClusterKind::kVehicle)];
  return vehicle > least_evidence && vehicle >= roadUserEvidence(c);
}

/// Drops what lies in the footprint of a likely vehicle: its seats, its roof, what is seen through
/// its windows.
void dropFragments(const LidarDetections& found, std::vector<JudgedCluster>& judged) {
  constexpr double kMargin = 0.3;  // [m] about the box of its returns (assumed)
  constexpr double kPerson = 1;    // evidence by which a person beside it stands (assumed)
  const auto placesOf = [&](const JudgedCluster& j) {
    std::vector<Vector2> places;
    places.reserve(j.points.size());
    for (const std::uint32_t i : j.points)
      places.emplace_back(static_cast<double>(found.x[i]), static_cast<double>(found.y[i]));
    return places;
  };
  std::vector<Vector2> centers;
  for (const JudgedCluster& j : judged) {
    Vector2 sum = Vector2::Zero();
    for (const Vector2& p : placesOf(j)) sum += p;
    centers.push_back(sum / static_cast<double>(j.points.size()));
  }
  const Vector2 sensor = found.points.sensor.head<2>();
  std::vector<char> fragment(judged.size(), 0);
  for (std::size_t v = 0; v < judged.size(); ++v) {
    if (!isVehicle(judged[v], 0)) continue;
    const auto box = fitBox(placesOf(judged[v]), sensor, true, true, BoxParams{});
    if (!box) continue;
    const Vector2 along(std::cos(box->yaw), std::sin(box->yaw));
    for (std::size_t i = 0; i < judged.size(); ++i) {
      if (i == v || judged[i].points.size() >= judged[v].points.size() ||
          std::max(judged[i].evidence[0], judged[i].evidence[1]) >= kPerson)
        continue;
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
  constexpr double kSureVehicle =
      2;  // evidence: with one in ten clusters, as likely as not (assumed)
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
  for (const std::uint32_t i : obstacles)
    phantom.center += Vector2(found.x[i], found.y[i]) / static_cast<double>(obstacles.size());
  if (found.trust.empty()) return phantom;
  for (const std::uint32_t i : obstacles)
    if (found.trust[i] < kDoubted)
      phantom.doubted.push_back(found.points.source[found.obstacles[i]]);
  return phantom;
}

/// Marks the clusters that stand for themselves; `own`: probability of the likeliest road user.
std::vector<char> standing(const std::vector<DescribedCluster>& clusters,
                           const std::vector<double>& own) {
  const std::size_t n = clusters.size();
  std::vector<double> best_part(n, 0);  // over all parts of parts
  for (std::size_t i = n; i-- > 0;) {   // parts come after their whole
    if (const int whole = clusters[i].segment.whole; whole >= 0) {
      double& best = best_part[static_cast<std::size_t>(whole)];
      best = std::max({best, own[i], best_part[i]});
    }
  }
  std::vector<char> stands(n, 0), in_parts(n, 0);  // reached from above; is given as its parts
  for (std::size_t i = 0; i < n; ++i) {
    const int whole = clusters[i].segment.whole;
    const bool reached = whole < 0 || in_parts[static_cast<std::size_t>(whole)];
    in_parts[i] = reached && own[i] < kSureWhole && best_part[i] > std::max(kLeastPart, own[i]);
    stands[i] = reached && !in_parts[i];
  }
  return stands;
}

}  // namespace

Judgement judgedClusters(const LidarDetections& found, const LidarCloud& cloud,
                         const ClusterClassifier& classifier) {
  std::vector<Probabilities> probabilities;
  std::vector<double> own;  // of the likeliest road user
  const DirectionCells cells(found.points);
  auto clusters = describedClusters(found, cloud, cells, [&](const DescribedCluster& cluster) {
    const auto p = withinSize(classifier.probabilities(cluster.descriptor), cluster.descriptor);
    probabilities.push_back(p), own.push_back(roadUser(p));
    return own.back() < kSureWhole &&
           at(p, ClusterKind::kThing) + at(p, ClusterKind::kPhantom) < kSureThing;
  });
  const std::size_t n = clusters.size();
  std::vector<Probabilities> wholes;
  for (std::size_t i = 0; i < n; ++i)
    if (clusters[i].segment.whole < 0) wholes.push_back(probabilities[i]);
  const PhantomMix mix(wholes, classifier.prior());
  const std::vector<char> stands = standing(clusters, own);
  Judgement judgement;
  std::vector<JudgedCluster>& judged = judgement.clusters;
  judgement.phantom.assign(found.obstacles.size(), PlacedReturns::kNoCluster);
  for (std::size_t i = 0; i < n; ++i) {
    if (!stands[i]) continue;
    const Probabilities p = mix(probabilities[i]);
    const double phantom = at(p, ClusterKind::kPhantom);
    for (const std::uint32_t point : clusters[i].segment.points)
      judgement.phantom[point] = static_cast<float>(phantom);
    ++judgement.verdicts.clusters;
    if (phantom > kSurePhantom && own[i] < kHardlyRoadUser) {
      judgement.verdicts.phantoms.push_back(phantomOf(found, clusters[i].segment.points, phantom));
      continue;
    }
    JudgedCluster cluster;
    cluster.phantom = phantom;
    cluster.evidence = classifier.evidence(p);
    if (roadUserEvidence(cluster) < kSurelyThing) continue;
    cluster.points = std::move(clusters[i].segment.points);
    const float isolation = clusters[i].descriptor[static_cast<std::size_t>(Feature::kIsolation)];
    cluster.alone = isolation > 0.5f;
    judged.push_back(std::move(cluster));
  }
  dropFragments(found, judged);
  dropLoose(found, cells, judged);
  judgement.verdicts.suspicious = static_cast<std::size_t>(
      std::count_if(judged.begin(), judged.end(),
                    [](const JudgedCluster& c) { return c.phantom > kSuspicious; }));
  return judgement;
}

}  // namespace perception
