#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/interop/ros/RosMessages.h"
#include "libperception/interop/ros/RosWire.h"

namespace perception::ros {

// Messages of drivers: their own clouds, and packets as the device sent them.

/// Livox's CustomMsg, of all its drivers.
struct LivoxPoint {
  std::uint32_t offset_time = 0;   ///< [ns] after the message's time
  std::array<float, 3> place{};    ///< [m]
  std::uint8_t reflectivity = 0;   ///< 0 to 255
  std::uint8_t tag = 0, line = 0;  ///< the laser's number
};
template <class Wire>
void fields(Wire& w, LivoxPoint& m) {
  w(m.offset_time), w(m.place), w(m.reflectivity), w(m.tag), w(m.line);
}

struct LivoxScan {
  Header header;
  std::uint64_t timebase = 0;  ///< [ns] of the first point, by the device
  std::uint32_t point_num = 0;
  std::uint8_t lidar_id = 0;
  std::array<std::uint8_t, 3> reserved{};
  std::vector<LivoxPoint> points;
};
template <class Wire>
void fields(Wire& w, LivoxScan& m) {
  w(m.header), w(m.timebase), w(m.point_num), w(m.lidar_id), w(m.reserved), w(m.points);
}

/// velodyne_msgs/VelodynePacket.
struct VelodynePacket {
  Stamp stamp;  ///< of reception
  FixedBytes<1206> data;
};
template <class Wire>
void fields(Wire& w, VelodynePacket& m) {
  w(m.stamp), w(m.data);
}

/// pandar_msgs/PandarPacket, hesai_ros_driver/UdpPacket: `size` bytes of data are used.
struct PandarPacket {
  Stamp stamp;
  FixedBytes<1500> data;
  std::uint32_t size = 0;
};
template <class Wire>
void fields(Wire& w, PandarPacket& m) {
  w(m.stamp), w(m.data), w(m.size);
}

/// rslidar_msgs/rslidarPacket, and rslidar_msg/RslidarPacket of drivers before 1.3.
struct RslidarPacket {
  Stamp stamp;
  FixedBytes<1248> data;
};
template <class Wire>
void fields(Wire& w, RslidarPacket& m) {
  w(m.stamp), w(m.data);
}

/// rslidar_msg/RslidarPacket of drivers from 1.3 on.
struct RslidarMessage {
  Header header;
  std::uint8_t is_difop = 0, is_frame_begin = 0;
  std::string_view data;
};
template <class Wire>
void fields(Wire& w, RslidarMessage& m) {
  w(m.header), w(m.is_difop), w(m.is_frame_begin), w(m.data);
}

/// velodyne_msgs/VelodyneScan, pandar_msgs/PandarScan, hesai_ros_driver/UdpFrame,
/// rslidar_msgs/rslidarScan.
template <class Packet>
struct PacketScan {
  Header header;
  std::vector<Packet> packets;
};
template <class Wire, class Packet>
void fields(Wire& w, PacketScan<Packet>& m) {
  w(m.header), w(m.packets);
}
using VelodyneScan = PacketScan<VelodynePacket>;
using PandarScan = PacketScan<PandarPacket>;
using RslidarScan = PacketScan<RslidarPacket>;

/// PacketMsg of Ouster's drivers.
struct OusterPacket {
  std::string_view bytes;
};
template <class Wire>
void fields(Wire& w, OusterPacket& m) {
  w(m.bytes);
}

/// can_msgs/Frame.
struct CanFrame {
  Header header;
  std::uint32_t id = 0;
  std::uint8_t is_rtr = 0, is_extended = 0, is_error = 0;
  std::uint8_t length = 0;  ///< [bytes] of the data that are used
  FixedBytes<8> data;
};
template <class Wire>
void fields(Wire& w, CanFrame& m) {
  w(m.header), w(m.id), w(m.is_rtr), w(m.is_extended), w(m.is_error), w(m.length), w(m.data);
}

/// std_msgs/String.
struct Text {
  std::string text;
};
template <class Wire>
void fields(Wire& w, Text& m) {
  w(m.text);
}

/// radar_msgs/RadarTrack: an object of a radar's own tracker.
struct RadarTrack {
  std::array<std::uint8_t, 16> id{};
  std::array<double, 3> position{}, velocity{}, acceleration{}, size{};  ///< [m], [s]
  std::uint16_t classification = 0;
  std::array<float, 24> covariances{};  ///< six each: of position, velocity, acceleration, size
};
template <class Wire>
void fields(Wire& w, RadarTrack& m) {
  w(m.id), w(m.position), w(m.velocity), w(m.acceleration), w(m.size), w(m.classification);
  w(m.covariances);
}

struct RadarTracks {
  Header header;
  std::vector<RadarTrack> tracks;
};
template <class Wire>
void fields(Wire& w, RadarTracks& m) {
  w(m.header), w(m.tracks);
}

/// sensor_msgs/LaserScan: ranges of one layer, counter-clockwise where the increment is positive.
struct LaserScan {
  Header header;                                            ///< stamp of the first range
  float angle_min = 0, angle_max = 0, angle_increment = 0;  ///< [rad] from x to y
  float time_increment = 0, scan_time = 0;                  ///< [s] between two ranges, two scans
  float range_min = 0, range_max = 0;                       ///< [m]
  std::vector<float> ranges, intensities;                   ///< [m]; a device's own units, or none
};
template <class Wire>
void fields(Wire& w, LaserScan& m) {
  w(m.header), w(m.angle_min), w(m.angle_max), w(m.angle_increment), w(m.time_increment);
  w(m.scan_time), w(m.range_min), w(m.range_max), w(m.ranges), w(m.intensities);
}

/// geometry_msgs/PoseWithCovarianceStamped.
struct PoseWithCovarianceStamped {
  Header header;
  Pose pose;
  std::array<double, 36> covariance{};
};
template <class Wire>
void fields(Wire& w, PoseWithCovarianceStamped& m) {
  w(m.header), w(m.pose), w(m.covariance);
}

/// nav_msgs/Path.
struct Path {
  Header header;
  std::vector<PoseStamped> poses;
};
template <class Wire>
void fields(Wire& w, Path& m) {
  w(m.header), w(m.poses);
}

}  // namespace perception::ros
