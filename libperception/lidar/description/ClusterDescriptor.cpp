#include "libperception/lidar/description/ClusterDescriptor.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "libperception/core/Frames.h"
#include "libperception/lidar/description/DescriptorParts.h"
#include "libperception/lidar/outline/EdgeFit.h"
#include "libperception/simd/Dispatch.h"
#include "libperception/simd/Vector8.h"

namespace perception {
namespace {

constexpr int kSlices = 5;  // heights of the outline
/// Returns of which these are computed at most, evenly among those of a cluster: a wall of 10,000
/// shows nothing that these do not.
constexpr std::size_t kOutlineSample = 200, kSpreadSample = 400, kRoughnessSample = 800;

std::size_t strideOf(std::size_t count, std::size_t sample) { return 1 + (count - 1) / sample; }

/// Least box around points along two axes: how far they reach along each and against it, so that
/// one comparison of four numbers serves all its sides.
struct Box {
  static constexpr float kNone = -1e30f;
  Float4 ends = all<Float4>(kNone);
  void add(const Float4& reach) { ends = larger(reach, ends); }
  float size(std::size_t axis) const {
    return ends[axis] > kNone ? ends[axis] + ends[axis + 2] : 0;
  }
};

/// Sum, products and number of points: their covariance.
struct Moments {
  Vector3 sum = Vector3::Zero();
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  double count = 0;
  void add(float fx, float fy, float fz) {
    const auto x = static_cast<double>(fx), y = static_cast<double>(fy),
               z = static_cast<double>(fz);
    sum += Vector3(x, y, z), ++count;
    xx += x * x, xy += x * y, xz += x * z, yy += y * y, yz += y * z, zz += z * z;
  }
  Eigen::Matrix3d covariance() const {
    const Vector3 mean = sum / count;
    Eigen::Matrix3d products;
    products << xx, xy, xz, xy, yy, yz, xz, yz, zz;
    return products / count - mean * mean.transpose();
  }
};

}  // namespace

const std::array<const char*, kFeatures>& featureNames() {
  static const std::array<const char*, kFeatures> names = {"length",
                                                           "width",
                                                           "height",
                                                           "bottom",
                                                           "top",
                                                           "area",
                                                           "elongation",
                                                           "uprightness",
                                                           "spread_1",
                                                           "spread_2",
                                                           "spread_3",
                                                           "linearity",
                                                           "planarity",
                                                           "scatter",
                                                           "normal_up",
                                                           "direction_up",
                                                           "length_1",
                                                           "length_2",
                                                           "length_3",
                                                           "length_4",
                                                           "length_5",
                                                           "width_1",
                                                           "width_2",
                                                           "width_3",
                                                           "width_4",
                                                           "width_5",
                                                           "share_1",
                                                           "share_2",
                                                           "share_3",
                                                           "share_4",
                                                           "share_5",
                                                           "edge_distance",
                                                           "edge_share",
                                                           "log_returns",
                                                           "log_surface",
                                                           "seen_area",
                                                           "fill",
                                                           "rows",
                                                           "columns",
                                                           "row_share",
                                                           "roughness",
                                                           "holes",
                                                           "through",
                                                           "cut",
                                                           "intensity_mean",
                                                           "intensity_spread",
                                                           "intensity_high",
                                                           "range",
                                                           "isolation",
                                                           "aspect",
                                                           "top_spread",
                                                           "touching"};
  return names;
}

ClusterDescriber::ClusterDescriber(const LidarDetections& found, const LidarCloud& cloud,
                                   const DirectionCells& cells)
    : found_(found), cells_(cells) {
  const EgoPoints& points = found.points;
  const std::size_t n = found.obstacles.size();
  const auto sx = static_cast<float>(points.sensor.x()), sy = static_cast<float>(points.sensor.y()),
             sz = static_cast<float>(points.sensor.z());
  dx_.resize(n), dy_.resize(n), dz_.resize(n), place_.resize(n);
  for (std::size_t k = 0; k < n; ++k) {
    dx_[k] = found.x[k] - sx, dy_[k] = found.y[k] - sy;
    dz_[k] = points.z[found.obstacles[k]] - sz;
    place_[k] = cells.placeOf(found.obstacles[k]);
  }
  rankIntensities(cloud);
  sortByPlace();
}

/// Numbers of clusters go on from scan to scan, so that old ones need not be wiped.
void ClusterDescriber::Members::begin(std::size_t obstacles) {
  if (own == std::numeric_limits<std::int32_t>::max()) number.clear(), own = 0;
  if (number.size() < obstacles) number.resize(obstacles, 0);
  ++own;
}

Descriptor ClusterDescriber::describe(const std::vector<std::uint32_t>& members) const {
  thread_local Members memory;
  Members& c = memory;
  c.begin(rank_.size());
  Descriptor d{};
  const std::size_t count = members.size();
  c.x.resize(count), c.y.resize(count), c.z.resize(count), c.h.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t k = members[i];
    c.x[i] = dx_[k], c.y[i] = dy_[k], c.z[i] = dz_[k], c.h[i] = found_.above[k];
    c.number[rank_[k]] = c.own;
  }
  const auto n = static_cast<float>(members.size());
  const float mx = std::accumulate(c.x.begin(), c.x.end(), 0.0f) / n,
              my = std::accumulate(c.y.begin(), c.y.end(), 0.0f) / n;
  at(d, Feature::kRange) = std::hypot(mx, my);
  describeEdges(c, d);  // first: slices, aspect and widths refer to its direction
  at(d, Feature::kAspect) =
      std::abs(c.along_x * mx + c.along_y * my) / std::max(at(d, Feature::kRange), 1e-3f);
  describeOutline(c, d);
  describeSpread(c, d);
  describeRoughness(c, d);
  describeDirections(c, members, d);
  describeIntensity(members, d);
  describeNeighbors(c, members, d);
  return d;
}

void ClusterDescriber::describeEdges(Members& c, Descriptor& d) {
  const std::size_t stride = strideOf(c.x.size(), kOutlineSample);
  const std::size_t count = (c.x.size() - 1) / stride + 1;
  const EdgeFit fit =
      fitEdges({count, [&](std::size_t i) {
                  return std::make_pair(c.x[i * stride] - c.x[0], c.y[i * stride] - c.y[0]);
                }});
  c.along_x = fit.along_x, c.along_y = fit.along_y;
  at(d, Feature::kEdgeDistance) = fit.distance / static_cast<float>(count);
  at(d, Feature::kEdgeShare) = fit.close / static_cast<float>(count);
}

PERCEPTION_WIDER void ClusterDescriber::describeOutline(const Members& c, Descriptor& d) {
  const std::size_t n = c.x.size();
  std::vector<float> heights;
  heights.reserve(kSpreadSample);
  const std::size_t stride = strideOf(n, kSpreadSample);
  for (std::size_t i = 0; i < n; i += stride) heights.push_back(c.h[i]);
  const float bottom = quantile(heights, 0.01), top = quantile(heights, 0.99);
  const float height = std::max(top - bottom, 0.05f);
  Box whole;
  std::array<Box, kSlices> slices;
  std::array<int, kSlices> count{};
  Interval top_x, top_y;
  const Float4 of_x = {c.along_x, -c.along_y, -c.along_x, c.along_y},
               of_y = {c.along_y, c.along_x, -c.along_y, -c.along_x};
  for (std::size_t i = 0; i < n; ++i) {
    const auto slice = static_cast<std::size_t>(
        std::clamp(static_cast<int>((c.h[i] - bottom) / height * kSlices), 0, kSlices - 1));
    slices[slice].add(c.x[i] * of_x + c.y[i] * of_y), ++count[slice];
    if (c.h[i] > top - 0.3f) top_x.add(c.x[i]), top_y.add(c.y[i]);
  }
  for (const Box& slice : slices) whole.add(slice.ends);
  const float length = whole.size(0), width = whole.size(1);
  at(d, Feature::kLength) = length, at(d, Feature::kWidth) = width;
  at(d, Feature::kHeight) = height, at(d, Feature::kBottom) = bottom, at(d, Feature::kTop) = top;
  at(d, Feature::kArea) = length * width;
  at(d, Feature::kElongation) = length / std::max(width, 0.05f);
  at(d, Feature::kUprightness) = height / std::max(length, 0.05f);
  at(d, Feature::kTopSpread) = std::hypot(top_x.size(), top_y.size());
  for (int k = 0; k < kSlices; ++k) {
    const auto s = static_cast<std::size_t>(k);
    at(d, Feature::kLength1, k) = slices[s].size(0);
    at(d, Feature::kWidth1, k) = slices[s].size(1);
    at(d, Feature::kShare1, k) = static_cast<float>(count[s]) / static_cast<float>(n);
  }
  const auto returns = static_cast<float>(n);
  const float range = at(d, Feature::kRange);
  at(d, Feature::kLogReturns) = std::log(returns);
  at(d, Feature::kLogSurface) = std::log(returns * range * range);
}

void ClusterDescriber::describeSpread(const Members& c, Descriptor& d) {
  Moments moments;
  const std::size_t stride = strideOf(c.x.size(), kSpreadSample);
  // About the first return: differences of large numbers lose digits.
  for (std::size_t i = 0; i < c.x.size(); i += stride)
    moments.add(c.x[i] - c.x[0], c.y[i] - c.y[0], c.z[i] - c.z[0]);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(moments.covariance());
  std::array<float, 3> spread{};  // largest first
  for (int k = 0; k < 3; ++k)
    spread[static_cast<std::size_t>(k)] =
        static_cast<float>(std::sqrt(std::max(solver.eigenvalues()[2 - k], 1e-6)));
  for (int k = 0; k < 3; ++k) at(d, Feature::kSpread1, k) = spread[static_cast<std::size_t>(k)];
  at(d, Feature::kLinearity) = (spread[0] - spread[1]) / spread[0];
  at(d, Feature::kPlanarity) = (spread[1] - spread[2]) / spread[0];
  at(d, Feature::kScatter) = spread[2] / spread[0];
  at(d, Feature::kNormalUp) = static_cast<float>(std::abs(solver.eigenvectors()(2, 0)));
  at(d, Feature::kDirectionUp) = static_cast<float>(std::abs(solver.eigenvectors()(2, 2)));
}

/// Share of the least eigenvalue of the returns in cubes of 0.4 m: 0 for planes, 1/3 for leaves.
void ClusterDescriber::describeRoughness(const Members& c, Descriptor& d) {
  constexpr float kPerMeter = 2.5f;
  constexpr double kLeast = 5;  // returns in a cube
  const std::size_t stride = strideOf(c.x.size(), kRoughnessSample);
  thread_local std::vector<std::uint64_t> memory;
  std::vector<std::uint64_t>& cube_of = memory;  // before the index of each return
  cube_of.clear();
  const auto cell = [&](float v, float origin) {
    return static_cast<std::uint64_t>(static_cast<int>((v - origin) * kPerMeter) + 512) & 1023u;
  };
  const float x0 = c.x[0] - 100, y0 = c.y[0] - 100, z0 = c.z[0] - 100;
  for (std::size_t i = 0; i < c.x.size(); i += stride)
    cube_of.push_back(cell(c.x[i], x0) << 52 | cell(c.y[i], y0) << 42 | cell(c.z[i], z0) << 32 | i);
  std::sort(cube_of.begin(), cube_of.end());
  double least = 0, all = 0;
  for (std::size_t begin = 0; begin < cube_of.size();) {
    Moments moments;
    std::size_t end = begin;
    const auto returnOf = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
    const std::size_t first = returnOf(cube_of[begin]);
    for (; end < cube_of.size() && cube_of[end] >> 32 == cube_of[begin] >> 32; ++end) {
      const std::size_t i = returnOf(cube_of[end]);
      moments.add(c.x[i] - c.x[first], c.y[i] - c.y[first], c.z[i] - c.z[first]);
    }
    begin = end;
    if (moments.count < kLeast) continue;
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    const Eigen::Matrix3d covariance = moments.covariance();
    solver.computeDirect(covariance, Eigen::EigenvaluesOnly);
    const double trace = covariance.trace();
    if (trace <= 0) continue;
    least += moments.count * std::max(0.0, solver.eigenvalues()[0]) / trace;
    all += moments.count;
  }
  at(d, Feature::kRoughness) = all > 0 ? static_cast<float>(least / all) : -1;
}

}  // namespace perception
