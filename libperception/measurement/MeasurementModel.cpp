#include "libperception/measurement/MeasurementModel.h"

namespace perception {

AxisVector residual(const MeasurementModel& model, const Measurement& m, const AxisVector& h) {
  AxisVector y(kMaxAxes);
  Eigen::Index rows = 0;
  const auto& axes = model.axes();
  for (std::size_t i = 0; i < axes.size(); ++i) {
    if (!(m.seen >> i & 1)) continue;
    const auto k = static_cast<Eigen::Index>(i);
    const double difference = m.z[k] - h[k];
    y[rows++] = axes[i] == AxisKind::kAngle ? wrapAngle(difference) : difference;
  }
  y.conservativeResize(rows);
  return y;
}

}  // namespace perception
