#pragma once
#include <optional>

#include "libperception/vision/VisionFrontEnd.h"
#include "tests/vision/KittiDrive.h"

namespace perception {

/// One image box against the labeled object that it overlaps by half or more.
struct BoxResidual {
  bool person = false;
  double truth_range = 0;                     ///< [m] to the nearest point of the labeled footprint
  Vector3 error = Vector3::Zero();            ///< z - h of left, right [rad], range [m]
  Vector3 sigma = Vector3::Zero();            ///< as stated by the front end
  double height_error = 0, height_sigma = 0;  ///< [m]
  double box_angle = 0;                       ///< [rad] between its edges
  AxisMask seen = 0;
  std::optional<double> heading_error;  ///< [rad] measured less true heading, where there is one
  double heading_sigma = 0;             ///< [rad] of the axis, as stated
};

/// The plane ahead (z = a x + c) on which a drive's labeled objects stand: what a measured ground
/// would give on average.
inline GroundPlane groundOf(const KittiDrive& drive) {
  double n = 0, sx = 0, sz = 0, sxx = 0, sxz = 0;
  for (const auto& [number, objects] : drive.truth) {
    for (const KittiTruth& o : objects) {
      const double x = o.bottom.x(), z = o.bottom.z();
      if (x < 5 || x > 40) continue;
      n += 1, sx += x, sz += z, sxx += x * x, sxz += x * z;
    }
  }
  GroundPlane ground;
  if (n < 2) return ground;
  ground.a = (n * sxz - sx * sz) / (n * sxx - sx * sx);
  ground.c = (sz - ground.a * sx) / n;
  ground.measured = true;
  return ground;
}

/// All boxes of a drive that lie on a labeled object which is neither cut off nor largely hidden.
inline std::vector<BoxResidual> boxResiduals(const KittiDrive& drive, const FrontEnd& front_end,
                                             const GroundPlane& ground) {
  std::vector<BoxResidual> out;
  for (const auto& [number, boxes] : drive.boxes) {
    const auto truth = drive.truth.find(number);
    if (truth == drive.truth.end()) continue;
    SensorFrame frame;
    frame.sensor = "rrc";
    frame.T_ego_sensor = drive.T_ego_camera;
    frame.ground = ground;
    frame.data = ObjectDetections{drive.camera, boxes, std::nullopt};
    const MeasurementScan scan = front_end.extract(frame);
    for (const Measurement& m : scan.measurements) {
      const auto& detection = boxes[static_cast<std::size_t>(m.detection)];
      const auto best = std::max_element(truth->second.begin(), truth->second.end(),
                                         [&](const auto& a, const auto& b) {
                                           return overlap(a.image_box, *detection.image_box) <
                                                  overlap(b.image_box, *detection.image_box);
                                         });
      if (overlap(best->image_box, *detection.image_box) < 0.5) continue;
      const bool person = detection.label == "Pedestrian";
      if (best->truncated > 0 || best->occluded > 1) continue;
      if (person != (best->type == "Pedestrian" || best->type == "Cyclist")) continue;
      Kinematics object;
      object.q << best->bottom.x(), best->bottom.y(), 0, 0, best->yaw;
      object.has_yaw = true;
      const Extent extent{best->length, best->width, 0, 0};
      AxisPrediction predicted;
      scan.model->predict(&object, &extent, 1, scan.state, &predicted);
      if (!predicted.defined) continue;
      BoxResidual r;
      r.person = person;
      r.seen = m.seen;
      r.box_angle = wrapAngle(m.z[0] - m.z[1]);
      r.truth_range = predicted.h[FootprintModel::kRange];
      r.error = Vector3(wrapAngle(m.z[0] - predicted.h[0]), wrapAngle(m.z[1] - predicted.h[1]),
                        m.z[2] - predicted.h[2]);
      r.sigma = m.R.diagonal().cwiseSqrt();
      if (m.height) {
        r.height_error = m.height->mean - best->height;
        r.height_sigma = std::sqrt(m.height->variance);
      }
      if (m.heading) {
        r.heading_error = wrapAngle(m.heading->yaw - best->yaw);
        r.heading_sigma = m.heading->sigma;
      }
      out.push_back(r);
    }
  }
  return out;
}

}  // namespace perception
