#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/interop/ros/RosWire.h"

namespace perception::ros {

// Messages of ROS 1 and 2 that both encode in the same order (std_msgs/Header apart, see
// RosWire.h); members behind the last one that is read are left out. Quantities as in ROS's REP
// 103: m, rad, s; x forward, y left, z up, but optical frames.

struct Header {
  Stamp stamp;
  std::string frame_id;
};
template <class Wire>
void fields(Wire& w, Header& m) {
  if constexpr (Wire::Wire::kHeaderNumber) {
    std::uint32_t number = 0;
    w(number);
  }
  w(m.stamp), w(m.frame_id);
}

struct Quaternion {
  double x = 0, y = 0, z = 0, w = 1;
  auto members() { return std::tie(x, y, z, w); }
};

/// geometry_msgs/Pose and Transform.
struct Pose {
  std::array<double, 3> position{};
  Quaternion orientation;
  auto members() { return std::tie(position, orientation); }
};
/// Throws std::runtime_error unless all is finite and the quaternion of length 1, within 1 %.
Pose3 poseOf(const Pose& pose);
Pose messageOf(const Pose3& pose);

struct PoseStamped {
  Header header;
  Pose pose;
  auto members() { return std::tie(header, pose); }
};

struct Odometry {
  Header header;
  std::string child_frame_id;
  Pose pose;
  std::array<double, 36> pose_covariance{};
  std::array<double, 6> twist{};  ///< linear, angular; of the child frame
  std::array<double, 36> twist_covariance{};
  auto members() {
    return std::tie(header, child_frame_id, pose, pose_covariance, twist, twist_covariance);
  }
};

struct TransformStamped {
  Header header;
  std::string child_frame_id;
  Pose transform;  ///< p_parent = T p_child
  auto members() { return std::tie(header, child_frame_id, transform); }
};

struct TFMessage {
  std::vector<TransformStamped> transforms;
  auto members() { return std::tie(transforms); }
};

struct NavSatFix {
  Header header;
  std::int8_t status = 0;  ///< -1: no fix
  std::uint16_t service = 1;
  double latitude = 0, longitude = 0;  ///< [deg]
  double altitude = 0;                 ///< [m]
  std::array<double, 9> covariance{};  ///< [m^2] east, north, up
  std::uint8_t covariance_type = 0;
  auto members() {
    return std::tie(header, status, service, latitude, longitude, altitude, covariance,
                    covariance_type);
  }
};

struct Imu {
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};  ///< first -1: absent; of the others the same
  std::array<double, 3> rates{};                   ///< [rad/s]
  std::array<double, 9> rates_covariance{};
  std::array<double, 3> force{};  ///< [m/s^2]
  std::array<double, 9> force_covariance{};
  auto members() {
    return std::tie(header, orientation, orientation_covariance, rates, rates_covariance, force,
                    force_covariance);
  }
};

struct PointField {
  enum Type : std::uint8_t { kI8 = 1, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = kF32;
  std::uint32_t count = 1;
  auto members() { return std::tie(name, offset, datatype, count); }
};

struct PointCloud2 {
  Header header;
  std::uint32_t height = 1, width = 0;
  std::vector<PointField> point_fields;
  std::uint8_t is_bigendian = 0;
  std::uint32_t point_step = 0, row_step = 0;  ///< [bytes]
  std::string_view data;
  std::uint8_t is_dense = 1;
  auto members() {
    return std::tie(header, height, width, point_fields, is_bigendian, point_step, row_step, data,
                    is_dense);
  }
};

/// radar_msgs/RadarReturn: m, rad counter-clockwise, rad up, m/s, dB.
struct RadarReturn {
  float range = 0, azimuth = 0, elevation = 0, doppler_velocity = 0, amplitude = 0;
  auto members() { return std::tie(range, azimuth, elevation, doppler_velocity, amplitude); }
};

/// radar_msgs/RadarScan.
struct RadarScan {
  Header header;
  std::vector<RadarReturn> returns;
  auto members() { return std::tie(header, returns); }
};

struct Image {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  ///< [bytes] a row
  std::string_view data;
  auto members() { return std::tie(header, height, width, encoding, is_bigendian, step, data); }
};

struct CompressedImage {
  Header header;
  std::string format;
  std::string_view data;
  auto members() { return std::tie(header, format, data); }
};

struct CameraInfo {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string distortion_model;
  std::vector<double> D;
  std::array<double, 9> K{}, R{};
  std::array<double, 12> P{};
};
template <class Wire>
void fields(Wire& w, CameraInfo& m) {
  w(m.header), w(m.height), w(m.width), w(m.distortion_model), w(m.D), w(m.K), w(m.R), w(m.P);
  if constexpr (!Wire::kReads) {  // no binning, no region of interest
    w(std::array<std::uint32_t, 6>{}), w(std::uint8_t{0});
  }
}

/// vision_msgs/ObjectHypothesisWithPose of ROS 2.
struct ObjectHypothesis {
  std::string class_id;
  double score = 0;
  Pose pose;
  std::array<double, 36> covariance{};
  auto members() { return std::tie(class_id, score, pose, covariance); }
};

/// vision_msgs/Detection3D of ROS 2.
struct Detection3D {
  Header header;
  std::vector<ObjectHypothesis> results;
  Pose center;
  std::array<double, 3> size{};  ///< [m]
  std::string id;
  auto members() { return std::tie(header, results, center, size, id); }
};

struct Detection3DArray {
  Header header;
  std::vector<Detection3D> detections;
  auto members() { return std::tie(header, detections); }
};

}  // namespace perception::ros
