#include "libperception/measurement/models/FootprintInView.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "libperception/measurement/models/FootprintModel.h"

namespace perception {
namespace {

/// h and Jacobians of the bearing to a point of the object with the derivatives `dpoint`.
void setBearing(const Vector2& d, double forward, const Eigen::Matrix<double, 2, 5>& dpoint_dq,
                const Matrix2& dpoint_dextent, Eigen::Index row, AxisPrediction& out) {
  out.h[row] = wrapAngle(std::atan2(d.y(), d.x()) - forward);
  const Eigen::RowVector2d dbearing = perpendicular(d).transpose() / d.squaredNorm();
  out.H_q.row(row) = dbearing * dpoint_dq;
  out.H_extent.row(row) = dbearing * dpoint_dextent;
}

void resize(AxisPrediction& out) {
  out.h.resize(FootprintModel::kAxes);
  out.H_q.setZero(FootprintModel::kAxes, 5);
  out.H_extent.setZero(FootprintModel::kAxes, 2);
}

/// Corners (+-1, +-1) of a rectangle with sides along u and n: that of FootprintModel::kLeft, that
/// of kRight.
std::array<Vector2, 2> extremeCorners(const Vector2& d, const Vector2& u, const Vector2& n,
                                      const Vector2& half) {
  // Corners are compared by the tangents of their angles from the center's direction; by the angles
  // when the sensor is beside the object and corners lie behind it.
  const double middle = std::atan2(d.y(), d.x());
  const bool ahead = d.norm() > half.norm();
  std::array<Vector2, 2> corners;
  double left = -std::numeric_limits<double>::infinity(), right = -left;
  for (const double ex : {-1.0, 1.0}) {
    for (const double ey : {-1.0, 1.0}) {
      const Vector2 c = d + ex * half.x() * u + ey * half.y() * n;
      const double offset =
          ahead ? perpendicular(d).dot(c) / d.dot(c) : wrapAngle(std::atan2(c.y(), c.x()) - middle);
      if (offset > left) left = offset, corners[FootprintModel::kLeft] = {ex, ey};
      if (offset < right) right = offset, corners[FootprintModel::kRight] = {ex, ey};
    }
  }
  return corners;
}

}  // namespace

void predictDisc(const Vector2& d, const Extent& extent, double forward, AxisPrediction& out) {
  const double rho = d.norm(), radius = 0.25 * (extent.length + extent.width);
  out.defined = rho > radius + kClearance;
  if (!out.defined) return;
  resize(out);
  const double bearing = wrapAngle(std::atan2(d.y(), d.x()) - forward);
  const double ratio = radius / rho, half = std::asin(ratio), root = std::sqrt(1 - ratio * ratio);
  const Eigen::RowVector2d away = d.transpose() / rho,
                           across = perpendicular(d).transpose() / (rho * rho);
  const double sign[2] = {1, -1};
  for (Eigen::Index i = 0; i < 2; ++i) {
    out.h[i] = wrapAngle(bearing + sign[i] * half);
    out.H_q.row(i).head<2>() = across - sign[i] * ratio / (rho * root) * away;
    out.H_extent.row(i).setConstant(sign[i] * 0.25 / (rho * root));
  }
  out.h[FootprintModel::kRange] = rho - radius;
  out.H_q.row(FootprintModel::kRange).head<2>() = away;
  out.H_extent.row(FootprintModel::kRange).setConstant(-0.25);
}

void predictRectangle(const Vector2& d, double yaw, const Extent& extent, double corner_radius,
                      double forward, AxisPrediction& out) {
  const Vector2 u(std::cos(yaw), std::sin(yaw)), n = perpendicular(u);
  const Vector2 half(0.5 * extent.length, 0.5 * extent.width);
  const Vector2 sensor(-u.dot(d), -n.dot(d));  // in the object's frame
  Vector2 nearest(std::clamp(sensor.x(), -half.x(), half.x()),
                  std::clamp(sensor.y(), -half.y(), half.y()));
  out.defined = (sensor - nearest).norm() > kClearance;
  if (!out.defined) return;
  resize(out);
  const auto point = [&](const Vector2& own) { return Vector2(d + own.x() * u + own.y() * n); };
  // Derivatives (method.md (12)) of a point fixed in the object's frame up to its size: own = (ex
  // L/2, ey W/2) where e = +-1.
  Eigen::Matrix<double, 2, 5> dq;
  Matrix2 dextent;
  const auto derivatives = [&](const Vector2& own, const Vector2& e) {
    dq.setZero();
    dq.leftCols<2>().setIdentity();
    dq.col(4) = own.x() * n - own.y() * u;
    dextent.col(0) = 0.5 * e.x() * u;
    dextent.col(1) = 0.5 * e.y() * n;
  };
  // The point of the rounded corner e where its normal is `outward`, in the object's frame.
  const double round = std::min(corner_radius, 0.25 * extent.width);
  const double round_dwidth = round < corner_radius ? 0.25 : 0;
  const auto onCorner = [&](const Vector2& e, const Vector2& outward) {
    const Vector2 normal(u.dot(outward), n.dot(outward));
    const Vector2 own = e.cwiseProduct(half) + round * (normal - e);
    derivatives(own, e);
    dextent.col(1) += round_dwidth * (outward - e.x() * u - e.y() * n);
    return own;
  };
  const std::array<Vector2, 2> corners = extremeCorners(d, u, n, half);
  for (const Eigen::Index row : {FootprintModel::kLeft, FootprintModel::kRight}) {
    const Vector2& e = corners[static_cast<std::size_t>(row)];
    // The line of sight touches the circle of the corner.
    const Vector2 c = point(e.cwiseProduct(half - Vector2::Constant(round)));
    const double side = row == FootprintModel::kLeft ? 1 : -1, sine = round / c.norm();
    const Vector2 outward =
        (side * std::sqrt(1 - sine * sine) * perpendicular(c) - sine * c) / c.norm();
    setBearing(point(onCorner(e, outward)), forward, dq, dextent, row, out);
  }
  // Nearest point: along an edge or a rounded corner it slides, but then the distance does not
  // change to first order (envelope theorem).
  const Vector2 sign(sensor.x() > 0 ? 1 : -1, sensor.y() > 0 ? 1 : -1);
  const Vector2 past = sensor.cwiseAbs() - half + Vector2::Constant(round);
  if (past.x() > 0 && past.y() > 0) {
    const Vector2 normal = sign.cwiseProduct(past) / past.norm();
    nearest = onCorner(sign, normal.x() * u + normal.y() * n);
  } else {
    derivatives(nearest, past.x() > past.y() ? Vector2(sign.x(), 0) : Vector2(0, sign.y()));
  }
  const double distance = (sensor - nearest).norm();
  const Eigen::RowVector2d away = point(nearest).transpose() / distance;
  out.h[FootprintModel::kRange] = distance;
  out.H_q.row(FootprintModel::kRange) = away * dq;
  out.H_extent.row(FootprintModel::kRange) = away * dextent;
}

}  // namespace perception
