#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
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
};
template <class Wire>
void fields(Wire& w, Quaternion& m) {
  w(m.x), w(m.y), w(m.z), w(m.w);
}

/// geometry_msgs/Pose and Transform.
struct Pose {
  std::array<double, 3> position{};
  Quaternion orientation;
};
template <class Wire>
void fields(Wire& w, Pose& m) {
  w(m.position), w(m.orientation);
}
/// Throws std::runtime_error unless all is finite and the quaternion of length 1, within 1 %.
Pose3 poseOf(const Pose& pose);
Pose messageOf(const Pose3& pose);

struct PoseStamped {
  Header header;
  Pose pose;
};
template <class Wire>
void fields(Wire& w, PoseStamped& m) {
  w(m.header), w(m.pose);
}

struct Odometry {
  Header header;
  std::string child_frame_id;
  Pose pose;
  std::array<double, 36> pose_covariance{};
  std::array<double, 6> twist{};  ///< linear, angular; of the child frame
  std::array<double, 36> twist_covariance{};
};
template <class Wire>
void fields(Wire& w, Odometry& m) {
  w(m.header), w(m.child_frame_id), w(m.pose), w(m.pose_covariance), w(m.twist);
  w(m.twist_covariance);
}

struct TransformStamped {
  Header header;
  std::string child_frame_id;
  Pose transform;  ///< p_parent = T p_child
};
template <class Wire>
void fields(Wire& w, TransformStamped& m) {
  w(m.header), w(m.child_frame_id), w(m.transform);
}

struct TFMessage {
  std::vector<TransformStamped> transforms;
};
template <class Wire>
void fields(Wire& w, TFMessage& m) {
  w(m.transforms);
}

struct NavSatFix {
  Header header;
  std::int8_t status = 0;  ///< -1: no fix
  std::uint16_t service = 1;
  double latitude = 0, longitude = 0;  ///< [deg]
  double altitude = 0;                 ///< [m]
  std::array<double, 9> covariance{};  ///< [m^2] east, north, up
  std::uint8_t covariance_type = 0;
};
template <class Wire>
void fields(Wire& w, NavSatFix& m) {
  w(m.header), w(m.status), w(m.service), w(m.latitude), w(m.longitude), w(m.altitude);
  w(m.covariance), w(m.covariance_type);
}

struct Imu {
  Header header;
  Quaternion orientation;
  std::array<double, 9> orientation_covariance{};  ///< first -1: absent; of the others the same
  std::array<double, 3> rates{};                   ///< [rad/s]
  std::array<double, 9> rates_covariance{};
  std::array<double, 3> force{};  ///< [m/s^2]
  std::array<double, 9> force_covariance{};
};
template <class Wire>
void fields(Wire& w, Imu& m) {
  w(m.header), w(m.orientation), w(m.orientation_covariance), w(m.rates), w(m.rates_covariance);
  w(m.force), w(m.force_covariance);
}

struct PointField {
  enum Type : std::uint8_t { kI8 = 1, kU8, kI16, kU16, kI32, kU32, kF32, kF64 };
  std::string name;
  std::uint32_t offset = 0;
  std::uint8_t datatype = kF32;
  std::uint32_t count = 1;
};
template <class Wire>
void fields(Wire& w, PointField& m) {
  w(m.name), w(m.offset), w(m.datatype), w(m.count);
}

struct PointCloud2 {
  Header header;
  std::uint32_t height = 1, width = 0;
  std::vector<PointField> point_fields;
  std::uint8_t is_bigendian = 0;
  std::uint32_t point_step = 0, row_step = 0;  ///< [bytes]
  std::string_view data;
  std::uint8_t is_dense = 1;
};
template <class Wire>
void fields(Wire& w, PointCloud2& m) {
  w(m.header), w(m.height), w(m.width), w(m.point_fields), w(m.is_bigendian), w(m.point_step);
  w(m.row_step), w(m.data), w(m.is_dense);
}

/// radar_msgs/RadarReturn: m, rad counter-clockwise, rad up, m/s, dB.
struct RadarReturn {
  float range = 0, azimuth = 0, elevation = 0, doppler_velocity = 0, amplitude = 0;
};
template <class Wire>
void fields(Wire& w, RadarReturn& m) {
  w(m.range), w(m.azimuth), w(m.elevation), w(m.doppler_velocity), w(m.amplitude);
}

/// radar_msgs/RadarScan.
struct RadarScan {
  Header header;
  std::vector<RadarReturn> returns;
};
template <class Wire>
void fields(Wire& w, RadarScan& m) {
  w(m.header), w(m.returns);
}

struct Image {
  Header header;
  std::uint32_t height = 0, width = 0;
  std::string encoding;
  std::uint8_t is_bigendian = 0;
  std::uint32_t step = 0;  ///< [bytes] a row
  std::string_view data;
};
template <class Wire>
void fields(Wire& w, Image& m) {
  w(m.header), w(m.height), w(m.width), w(m.encoding), w(m.is_bigendian), w(m.step), w(m.data);
}

struct CompressedImage {
  Header header;
  std::string format;
  std::string_view data;
};
template <class Wire>
void fields(Wire& w, CompressedImage& m) {
  w(m.header), w(m.format), w(m.data);
}

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
};
template <class Wire>
void fields(Wire& w, ObjectHypothesis& m) {
  w(m.class_id), w(m.score), w(m.pose), w(m.covariance);
}

/// vision_msgs/Detection3D of ROS 2.
struct Detection3D {
  Header header;
  std::vector<ObjectHypothesis> results;
  Pose center;
  std::array<double, 3> size{};  ///< [m]
  std::string id;
};
template <class Wire>
void fields(Wire& w, Detection3D& m) {
  w(m.header), w(m.results), w(m.center), w(m.size), w(m.id);
}

struct Detection3DArray {
  Header header;
  std::vector<Detection3D> detections;
};
template <class Wire>
void fields(Wire& w, Detection3DArray& m) {
  w(m.header), w(m.detections);
}

}  // namespace perception::ros
