#include "libperception/lidar/description/ClusterDescriptor.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "libperception/core/Frames.h"
#include "libperception/lidar/description/DescriptorParts.h"
#include "libperception/lidar/outline/EdgeFit.h"
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
  }
  DirectionCells::placeAll(dx_.data(), dy_.data(), dz_.data(), n, place_.data());
  rankIntensities(cloud);
  sortByPlace();
}

Descriptor ClusterDescriber::describe(const std::vector<std::uint32_t>& members) {
  Descriptor d{};
  const std::size_t count = members.size();
  x_.resize(count), y_.resize(count), z_.resize(count), h_.resize(count);
  ++cluster_;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint32_t k = members[i];
    x_[i] = dx_[k], y_[i] = dy_[k], z_[i] = dz_[k], h_[i] = found_.above[k];
    sorted_mark_[rank_[k]] = cluster_;
  }
  const auto n = static_cast<float>(members.size());
  const float mx = std::accumulate(x_.begin(), x_.end(), 0.0f) / n,
              my = std::accumulate(y_.begin(), y_.end(), 0.0f) / n;
  at(d, Feature::kRange) = std::hypot(mx, my);
  describeEdges(d);  // first: slices, aspect and widths refer to its direction
  at(d, Feature::kAspect) =
      std::abs(along_x_ * mx + along_y_ * my) / std::max(at(d, Feature::kRange), 1e-3f);
  describeOutline(d);
  describeSpread(d);
  describeRoughness(d);
  describeDirections(members, d);
  describeIntensity(members, d);
  describeNeighbors(members, d);
  return d;
}

void ClusterDescriber::describeEdges(Descriptor& d) {
  const std::size_t stride = strideOf(x_.size(), kOutlineSample);
  const std::size_t count = (x_.size() - 1) / stride + 1;
  const EdgeFit fit =
      fitEdges({count, [&](std::size_t i) {
                  return std::make_pair(x_[i * stride] - x_[0], y_[i * stride] - y_[0]);
                }});
  along_x_ = fit.along_x, along_y_ = fit.along_y;
  at(d, Feature::kEdgeDistance) = fit.distance / static_cast<float>(count);
  at(d, Feature::kEdgeShare) = fit.close / static_cast<float>(count);
}

void ClusterDescriber::describeOutline(Descriptor& d) const {
  const std::size_t n = x_.size();
  std::vector<float> heights;
  heights.reserve(kSpreadSample);
  const std::size_t stride = strideOf(n, kSpreadSample);
  for (std::size_t i = 0; i < n; i += stride) heights.push_back(h_[i]);
  const float bottom = quantile(heights, 0.01), top = quantile(heights, 0.99);
  const float height = std::max(top - bottom, 0.05f);
  Box whole;
  std::array<Box, kSlices> slices;
  std::array<int, kSlices> count{};
  Interval top_x, top_y;
  const Float4 of_x = {along_x_, -along_y_, -along_x_, along_y_},
               of_y = {along_y_, along_x_, -along_y_, -along_x_};
  for (std::size_t i = 0; i < n; ++i) {
    const auto slice = static_cast<std::size_t>(
        std::clamp(static_cast<int>((h_[i] - bottom) / height * kSlices), 0, kSlices - 1));
    slices[slice].add(x_[i] * of_x + y_[i] * of_y), ++count[slice];
    if (h_[i] > top - 0.3f) top_x.add(x_[i]), top_y.add(y_[i]);
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

void ClusterDescriber::describeSpread(Descriptor& d) const {
  Moments moments;
  const std::size_t stride = strideOf(x_.size(), kSpreadSample);
  // About the first return: differences of large numbers lose digits.
  for (std::size_t i = 0; i < x_.size(); i += stride)
    moments.add(x_[i] - x_[0], y_[i] - y_[0], z_[i] - z_[0]);
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
void ClusterDescriber::describeRoughness(Descriptor& d) const {
  constexpr float kPerMeter = 2.5f;
  constexpr double kLeast = 5;  // returns in a cube
  const std::size_t stride = strideOf(x_.size(), kRoughnessSample);
  thread_local std::vector<std::uint64_t> memory;
  std::vector<std::uint64_t>& cube_of = memory;  // before the index of each return
  cube_of.clear();
  const auto cell = [&](float v, float origin) {
    return static_cast<std::uint64_t>(static_cast<int>((v - origin) * kPerMeter) + 512) & 1023u;
  };
  const float x0 = x_[0] - 100, y0 = y_[0] - 100, z0 = z_[0] - 100;
  for (std::size_t i = 0; i < x_.size(); i += stride)
    cube_of.push_back(cell(x_[i], x0) << 52 | cell(y_[i], y0) << 42 | cell(z_[i], z0) << 32 | i);
  std::sort(cube_of.begin(), cube_of.end());
  double least = 0, all = 0;
  for (std::size_t begin = 0; begin < cube_of.size();) {
    Moments moments;
    std::size_t end = begin;
    const auto returnOf = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
    const std::size_t first = returnOf(cube_of[begin]);
    for (; end < cube_of.size() && cube_of[end] >> 32 == cube_of[begin] >> 32; ++end) {
      const std::size_t i = returnOf(cube_of[end]);
      moments.add(x_[i] - x_[first], y_[i] - y_[first], z_[i] - z_[first]);
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
