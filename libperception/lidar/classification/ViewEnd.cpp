#include "libperception/lidar/classification/ViewEnd.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

/// [m] heights of people: 136 pedestrians in 17 KITTI sequences (27 cyclists are as high), with
/// 0.1 m of the local ground.
constexpr double kPersonHeight = 1.72, kPersonSigma = 0.165;
constexpr double kHigherThanPeople = 2.5;  // [m] with what they carry (assumed)
/// [1/m] share of the slim things of some height whose top is within the next meter: of 45 that are
/// 1.5 m or higher 13 end below 2.2 m (Argoverse 2, whose beams pass above them).
constexpr double kThingsEnd = 0.5;

/// [1/m] the same of people: the hazard of a Gaussian.
double peopleEnd(double height) {
  const double z = (height - kPersonHeight) / kPersonSigma;
  const double density = std::exp(-0.5 * z * z) / (kPersonSigma * std::sqrt(kTwoPi));
  return density / (0.5 * std::erfc(z / std::sqrt(2.0)));
}

/// Whether the next beam above a segment would be beyond the highest one, if the beams go on as
/// far apart as below its top. `slopes`: tangents of its returns' elevations, in any order.
bool isCut(std::vector<double> slopes, double top_slope) {
  constexpr double kOneBeam = 0.003;  // [-] within which returns are of one beam (assumed)
  constexpr double kWidest = 0.04;    // [-] 2.3 deg between beams (assumed)
  constexpr double kMost = 0.75;      // of the spacing, as beams are not even (assumed)
  std::sort(slopes.begin(), slopes.end(), std::greater<>());
  const double top = slopes.front();
  const auto last = std::adjacent_find(
      slopes.begin(), slopes.end(), [](double one, double next) { return one - next > kOneBeam; });
  if (last == slopes.end()) return false;
  return top + kMost * std::min(kWidest, *last - *std::next(last)) > top_slope;
}

}  // namespace

ViewEnd::ViewEnd(const LidarDetections& found, const DirectionCells& cells) : found_(found) {
  constexpr int kSector = 25;  // columns, 10 deg
  constexpr int kLeast = 3;    // sectors (assumed)
  const double elevation = std::atan(found.top_slope);
  const int top =
      static_cast<int>(std::floor(elevation / DirectionCells::kPitch)) + DirectionCells::kRows / 2;
  const double away = (kHigherThanPeople - found.points.sensor.z()) / std::sin(elevation);
  if (elevation <= 0 || top >= DirectionCells::kRows - 1) return;
  int sectors = 0;
  for (int first = 0; first < DirectionCells::kColumns && sectors < kLeast; first += kSector) {
    bool high = false;
    for (int c = first; c < first + kSector && !high; ++c)
      for (const int row : {top, top - 1})
        high = high || static_cast<double>(cells.at(c, row).farthest) > std::max(away, 0.0);
    sectors += high;
  }
  known_ = sectors >= kLeast;
}

double ViewEnd::evidence(const std::vector<std::uint32_t>& obstacles) const {
  if (!known_ || obstacles.empty()) return 0;
  const Vector3& sensor = found_.points.sensor;
  std::vector<double> slopes;
  slopes.reserve(obstacles.size());
  float top = 0;
  for (const std::uint32_t k : obstacles) {
    const std::uint32_t i = found_.obstacles[k];
    const double range = std::hypot(static_cast<double>(found_.points.x[i]) - sensor.x(),
                                    static_cast<double>(found_.points.y[i]) - sensor.y());
    slopes.push_back((static_cast<double>(found_.points.z[i]) - sensor.z()) / range);
    top = std::max(top, found_.above[k]);
  }
  if (!isCut(std::move(slopes), found_.top_slope)) return 0;
  return std::min(0.0, std::log(kThingsEnd / peopleEnd(static_cast<double>(top))));
}

void ViewEnd::weigh(DescribedCluster& cluster) const {
  constexpr double kHardly = 0.02;  // P(person) below which nothing depends on it (assumed)
  constexpr float kSlim = 1.2f;     // [m] longest side (assumed)
  double& pedestrian = cluster.probabilities[static_cast<std::size_t>(ClusterKind::kPedestrian)];
  double& cyclist = cluster.probabilities[static_cast<std::size_t>(ClusterKind::kCyclist)];
  const double person = pedestrian + cyclist;
  if (!known_ || person < kHardly ||
      cluster.descriptor[static_cast<std::size_t>(Feature::kLength)] > kSlim)
    return;
  const double factor = std::exp(evidence(cluster.segment.points));
  pedestrian *= factor, cyclist *= factor;
  // What is no surface stays as likely as it was, since the safety grid doubts what may be none.
  double& phantom = cluster.probabilities[static_cast<std::size_t>(ClusterKind::kPhantom)];
  const double was = phantom, surface = 1 - was;
  for (double& p : cluster.probabilities) p *= surface / (surface - (1 - factor) * person);
  phantom = was;
}

}  // namespace perception
