#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "libperception/core/math/Chi2.h"
#include "libperception/radar/RadarFrontEnd.h"

namespace perception {
namespace {

std::string data(const std::string& path) {
  return std::string(PERCEPTION_SHARED_DATA) + "/data/" + path;
}

ClassTable recordedClasses() {
  ObjectClass car;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  return {{car}};
}

RadarFrontEnd makeFrontEnd(const RadarParams& params = {}) {
  DetectionParams s;
  s.modality = Modality::kRadar;
  s.range_max = 200, s.fov = radians(120);
  return RadarFrontEnd(params, recordedClasses(), DetectionModel(s, {{}}, {"target"}));
}

double medianOf(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}

// ---------------------------------------------------------------- comma2k19: a Toyota's radar

/// Columns of a comma-separated file with a header.
std::vector<std::vector<double>> readColumns(const std::string& path) {
  std::ifstream file(path);
  std::vector<std::vector<double>> rows;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    rows.push_back(row);
  }
  return rows;
}

/// Linear interpolation of column `value` over column 0.
double at(const std::vector<std::vector<double>>& rows, double t, std::size_t value) {
  const auto after =
      std::lower_bound(rows.begin() + 1, rows.end() - 1, t,
                       [](const std::vector<double>& row, double time) { return row[0] < time; });
  const auto before = after - 1;
  const double share = std::clamp((t - (*before)[0]) / ((*after)[0] - (*before)[0]), 0.0, 1.0);
  return (*before)[value] + share * ((*after)[value] - (*before)[value]);
}

TEST(Comma2k19, StillObjectsCloseAtOwnSpeed) {
  const auto returns = readColumns(data("comma2k19_radar/radar_tracks.csv"));
  if (returns.empty()) GTEST_SKIP() << "no comma2k19 recording in " PERCEPTION_SHARED_DATA;
  const auto speed = readColumns(data("comma2k19_radar/ego_speed.csv"));
  const auto gyro = readColumns(data("comma2k19_radar/gyro.csv"));
  // The unit reports range and speed of its own filter, some 50 ms old: found by the residual's
  // least spread.
  constexpr double kAge = 0.05;  // [s]
  std::vector<double> still, along_track;
  const auto radar = makeFrontEnd();
  for (const auto& row : returns) {
    const double t = row[0] - kAge;
    SensorFrame frame;
    frame.ego.uncertainty = {0, 0, 0};
    frame.ego.velocity = {at(speed, t, 1), 0};
    frame.ego.yaw_rate = -at(gyro, t, 3);  // the gyro's z axis points down
    frame.T_ego_sensor =
        makePose(3.8, 0, 0.5, 0);  // at the bumper; the ego origin at the rear axle
    RadarReturn r;
    r.range = std::hypot(row[1], row[2]), r.bearing = std::atan2(row[2], row[1]);
    r.range_rate = row[3];
    frame.data = RadarReturns{{r}, 0};
    const auto scan = radar.extract(frame);
    ASSERT_EQ(scan.measurements.size(), 1u);
    const double over_ground = groundSpeed(scan.measurements[0], scan.state).mean;
    if (std::abs(over_ground) < 2) still.push_back(over_ground);
    if (std::abs(row[3] + frame.ego.velocity.x()) < 2)
      along_track.push_back(row[3] + frame.ego.velocity.x());
  }
  ASSERT_GT(still.size(), 1000u);
  const double median = medianOf(still);
  std::vector<double> off;
  double square = 0;
  for (const double v : still) off.push_back(std::abs(v - median)), square += v * v;
  const double spread = 1.4826 * medianOf(off), rms = std::sqrt(square / double(still.size()));
  double square2 = 0;
  for (const double v : along_track) square2 += v * v;
  // One part in a hundred of own speed (8 to 20 m/s) would be .15 m/s.
  EXPECT_LT(std::abs(median), 0.05);
  EXPECT_LT(spread, 0.15);
  EXPECT_LT(rms, 0.32);
  // Objects beside the road are seen along the line of sight, not along the track.
  EXPECT_LT(rms, 0.85 * std::sqrt(square2 / double(along_track.size())));
}

// ---------------------------------------------------------------- View-of-Delft: 3+1D radar

struct Labeled {
  std::string type;
  Vector3 bottom = Vector3::Zero();  ///< [m] lidar frame
  double yaw = 0, length = 0, width = 0, height = 0;
};

struct VodFrame {
  Pose3 T_lidar_radar = Pose3::Identity();
  RadarReturns returns;
  std::vector<double> compensated;     ///< [m/s] range rates with the own motion taken out
  Vector2 velocity = Vector2::Zero();  ///< [m/s] of the radar, lidar frame
  std::vector<Labeled> objects;
};

Pose3 readCalibration(const std::string& path) {
  std::ifstream file(path);
  Pose3 T_camera_sensor = Pose3::Identity();
  for (std::string line, key; std::getline(file, line);) {
    std::istringstream words(line);
    words >> key;
    if (key != "Tr_velo_to_cam:") continue;
    for (int i = 0; i < 12; ++i) words >> T_camera_sensor.matrix()(i / 4, i % 4);
  }
  return T_camera_sensor;
}

VodFrame readVod(const std::string& number) {
  VodFrame frame;
  const std::string folder = data("vod_radar/");
  const Pose3 T_camera_lidar = readCalibration(folder + "calib_lidar/" + number + ".txt");
  const Pose3 T_lidar_camera = T_camera_lidar.inverse();
  frame.T_lidar_radar = T_lidar_camera * readCalibration(folder + "calib_radar/" + number + ".txt");
  std::ifstream points(folder + "radar_points/" + number + ".bin", std::ios::binary);
  std::array<float, 7> p{};
  std::vector<Vector3> sight;
  std::vector<double> own;
  while (points.read(reinterpret_cast<char*>(p.data()), sizeof p)) {
    const Vector3 d(p[0], p[1], p[2]);
    RadarReturn r;
    r.range = d.norm();
    r.bearing = std::atan2(d.y(), d.x());
    r.elevation = std::atan2(d.z(), d.head<2>().norm());
    r.amplitude = p[3], r.range_rate = p[4];
    if (r.range <= 0) continue;
    frame.returns.returns.push_back(r);
    frame.compensated.push_back(p[5]);
    sight.push_back(frame.T_lidar_radar.linear() * d / r.range);
    own.push_back(p[5] - p[4]);
  }
  // range rate = u . (V - v_s) and compensated = u . V: v_s by least squares.
  Eigen::MatrixX3d A(static_cast<Eigen::Index>(sight.size()), 3);
  Eigen::VectorXd b(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    A.row(i) = sight[std::size_t(i)], b[i] = own[std::size_t(i)];
  if (A.rows() >= 3) frame.velocity = Vector3(A.colPivHouseholderQr().solve(b)).head<2>();
  std::ifstream labels(folder + "label_2/" + number + ".txt");
  for (std::string line; std::getline(labels, line);) {
    std::istringstream words(line);
    Labeled o;
    double skip = 0, x = 0, y = 0, z = 0, rotation = 0;
    words >> o.type;
    for (int i = 0; i < 7; ++i) words >> skip;
    words >> o.height >> o.width >> o.length >> x >> y >> z >> rotation;
    if (!words) continue;
    o.bottom = T_lidar_camera * Vector3(x, y, z);
    o.yaw = wrapAngle(-(rotation + kPi / 2));
    frame.objects.push_back(o);
  }
  return frame;
}

/// How many labeled objects, moved to the left by `aside` [m], have a target inside the gate of
/// the model (range and bearing).
struct Share {
  int objects = 0, associated = 0;
  double of() const { return double(associated) / std::max(1, objects); }
};

Share associated(double aside) {
  Share share;
  RadarParams params;  // about what the targets of these frames show: .2 m, 1.5 deg
  params.range_sigma = 0.2, params.bearing_sigma = radians(1.5), params.rate_sigma = 0.1;
  const double gate = chi2Quantile(0.999, 2);
  for (const char* number : {"00549", "01047"}) {
    const VodFrame vod = readVod(number);
    SensorFrame frame;
    frame.ego.uncertainty = {0, 0, 0};
    frame.ego.velocity = vod.velocity;
    frame.T_ego_sensor = vod.T_lidar_radar;
    frame.data = vod.returns;
    const auto scan = makeFrontEnd(params).extract(frame);
    for (const Labeled& o : vod.objects) {
      Kinematics k;
      k.q << o.bottom.x(), o.bottom.y() + aside, 0, 0, o.yaw;
      k.has_yaw = true;
      const Extent e{o.length, o.width, 0, 0};
      AxisPrediction p;
      scan.model->predict(&k, &e, 1, scan.state, &p);
      if (!p.defined) continue;
      ++share.objects;
      share.associated += std::any_of(scan.measurements.begin(), scan.measurements.end(),
                                      [&](const Measurement& m) {
                                        Measurement position = m;  // labels have no velocity
                                        position.seen = RadarModel::kNoRate;
                                        const AxisVector y = residual(*scan.model, position, p.h);
                                        const Matrix2 S = (m.R + p.R_model).topLeftCorner(2, 2);
                                        return y.dot(S.inverse() * y) < gate;
                                      });
    }
  }
  return share;
}

TEST(ViewOfDelft, NineInTenLabeledObjectsHaveATarget) {
  const Share share = associated(0);
  if (share.objects == 0) GTEST_SKIP() << "no View-of-Delft frames in " PERCEPTION_SHARED_DATA;
  EXPECT_EQ(share.objects, 39);
  EXPECT_GE(share.of(), 0.9);
  // Not by chance: the same objects beside their places.
  for (const double aside : {-7.0, -4.0, 4.0, 7.0})
    EXPECT_LT(associated(aside).of(), share.of() - 0.2);
}

}  // namespace
}  // namespace perception
