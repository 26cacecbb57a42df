#include "libperception/lidar/GroundSurface.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace perception {

void SurfaceParams::visit(ParamVisitor& v) {
  v.boolean("local", local, "follow the ground's departures from its plane");
  v.integer("sectors", sectors, {8, 720}, "cells around the sensor");
  v.real("ring", ring, {0.2, 20}, "m", "depth of a cell");
  v.integer("cell_points", cell_points, {1, 1000}, "returns that a cell needs");
  v.real("quantile", quantile, {0, 0.5}, "", "height of a cell's ground among its low returns");
  v.real("step", step, {0, 0.5}, "m", "change from one cell to the next outward");
  v.real("slope", slope, {0, 0.3}, "", "further change per metre since the last cell with ground");
  v.real("max_step", max_step, {0, 1}, "m", "largest change");
  v.real("bound_near", bound_near, {0, 1}, "m", "largest departure at the vehicle");
  v.real("bound_slope", bound_slope, {0, 0.2}, "", "growth of that bound with range");
}

namespace {

constexpr float kNoGround = std::numeric_limits<float>::quiet_NaN();
constexpr float kLowReturns =
    1.0f;                           // [m] above the plane: higher returns say nothing of the ground
constexpr float kSteepest = 0.10f;  // [-] slope of a ramp against the plane
constexpr float kMirrorMargin =
    0.30f;  // [m] below the lowest possible ground: mirrored in a wet road (SPEC 8.1)

float medianOfThree(float a, float b, float c) {
  return std::max(std::min(a, b), std::min(std::max(a, b), c));
}

}  // namespace

std::size_t GroundSurface::cellOf(float dx, float dy) const {
  const auto sector =
      static_cast<std::size_t>((roughBearing(dx, dy) + 3.14159265f) * inverse_sector_) % sectors_;
  const auto ring = static_cast<std::size_t>(std::sqrt(dx * dx + dy * dy) * inverse_ring_);
  return sector * rings_ + std::min(ring, rings_ - 1);
}

GroundSurface::GroundSurface(const GroundPlane& plane, const EgoPoints& points,
                             const SurfaceParams& params)
    : plane_(plane),
      sensor_x_(static_cast<float>(points.sensor.x())),
      sensor_y_(static_cast<float>(points.sensor.y())) {
  if (!params.local || points.size() == 0) {
    departure_.assign(1, 0);
    return;
  }
  float far2 = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float dx = points.x[i] - sensor_x_, dy = points.y[i] - sensor_y_;
    far2 = std::max(far2, dx * dx + dy * dy);
  }
  sectors_ = static_cast<std::size_t>(params.sectors);
  rings_ = 1 + static_cast<std::size_t>(std::sqrt(static_cast<double>(far2)) / params.ring);
  inverse_ring_ = static_cast<float>(1 / params.ring);
  inverse_sector_ = static_cast<float>(params.sectors / kTwoPi);

  // Heights above the plane by cell, low returns only.
  const auto a = static_cast<float>(plane.a), b = static_cast<float>(plane.b),
             c = static_cast<float>(plane.c);
  const auto bound_near = static_cast<float>(params.bound_near),
             bound_slope = static_cast<float>(params.bound_slope);
  std::vector<std::uint32_t> cell_of(points.size(), ~0u), start(sectors_ * rings_ + 1, 0);
  std::vector<float> height(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float dx = points.x[i] - sensor_x_, dy = points.y[i] - sensor_y_;
    height[i] = points.z[i] - (a * points.x[i] + b * points.y[i] + c);
    const float bound = bound_near + bound_slope * std::sqrt(dx * dx + dy * dy);
    if (height[i] > bound + kLowReturns || height[i] < -bound - kMirrorMargin) continue;
    cell_of[i] = static_cast<std::uint32_t>(cellOf(dx, dy));
    ++start[cell_of[i] + 1];
  }
  for (std::size_t k = 1; k < start.size(); ++k) start[k] += start[k - 1];
  std::vector<float> sorted(start.back());
  std::vector<std::uint32_t> next(start.begin(), start.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i)
    if (cell_of[i] != ~0u) sorted[next[cell_of[i]]++] = height[i];

  std::vector<float> lowest(sectors_ * rings_, kNoGround);
  for (std::size_t k = 0; k < lowest.size(); ++k) {
    const std::size_t count = start[k + 1] - start[k];
    if (count < static_cast<std::size_t>(params.cell_points)) continue;
    const auto first = sorted.begin() + start[k];
    const auto nth =
        first + static_cast<std::ptrdiff_t>(params.quantile * static_cast<double>(count));
    std::nth_element(first, nth, sorted.begin() + start[k + 1]);
    lowest[k] = *nth;
  }
  follow(std::move(lowest), params);
}

/// Outward along each sector: a cell's lowest return is ground if it can be reached from the ground
/// before it.
void GroundSurface::follow(std::vector<float> lowest, const SurfaceParams& params) {
  const auto ring = static_cast<float>(params.ring), step = static_cast<float>(params.step);
  const auto slope = static_cast<float>(params.slope),
             max_step = static_cast<float>(params.max_step);
  std::vector<float> along(lowest.size(), 0);
  for (std::size_t s = 0; s < sectors_; ++s) {
    float ground = 0, trend = 0, gap = ring;  // trend: slope against the plane, of a ramp
    for (std::size_t k = 0; k < rings_; ++k) {
      const float low = lowest[s * rings_ + k];
      const float range = (static_cast<float>(k) + 0.5f) * ring;
      const auto bound =
          static_cast<float>(params.bound_near) + static_cast<float>(params.bound_slope) * range;
      const float reach = std::min(step + slope * gap, max_step);
      const bool reached =
          std::abs(low - ground) <= reach || std::abs(low - ground - trend * gap) <= reach;
      if (std::abs(low) <= bound && reached) {  // false where nothing was seen
        trend = 0.5f * (trend + std::clamp((low - ground) / gap, -kSteepest, kSteepest));
        ground = low;
        gap = ring;
      } else {
        gap += ring;
      }
      along[s * rings_ + k] = ground;
    }
  }
  // A car's side that passed for ground stands alone among its neighbours.
  departure_.resize(along.size());
  for (std::size_t s = 0; s < sectors_; ++s) {
    const std::size_t left = (s + 1) % sectors_, right = (s + sectors_ - 1) % sectors_;
    for (std::size_t k = 0; k < rings_; ++k)
      departure_[s * rings_ + k] =
          medianOfThree(along[left * rings_ + k], along[s * rings_ + k], along[right * rings_ + k]);
  }
}

double GroundSurface::heightAt(double x, double y) const {
  const float departure = departure_.size() == 1
                              ? 0.0f
                              : departure_[cellOf(static_cast<float>(x) - sensor_x_,
                                                  static_cast<float>(y) - sensor_y_)];
  return plane_.heightAt(x, y) + static_cast<double>(departure);
}

std::vector<float> GroundSurface::heightsAbove(const EgoPoints& points) const {
  const auto a = static_cast<float>(plane_.a), b = static_cast<float>(plane_.b),
             c = static_cast<float>(plane_.c);
  std::vector<float> heights(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    heights[i] = points.z[i] - (a * points.x[i] + b * points.y[i] + c);
  if (departure_.size() > 1)
    for (std::size_t i = 0; i < points.size(); ++i)
      heights[i] -= departure_[cellOf(points.x[i] - sensor_x_, points.y[i] - sensor_y_)];
  return heights;
}

}  // namespace perception
