#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
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
  auto members() { return std::tie(offset_time, place, reflectivity, tag, line); }
};

struct LivoxScan {
  Header header;
  std::uint64_t timebase = 0;  ///< [ns] of the first point, by the device
  std::uint32_t point_num = 0;
  std::uint8_t lidar_id = 0;
  std::array<std::uint8_t, 3> reserved{};
  std::vector<LivoxPoint> points;
  auto members() { return std::tie(header, timebase, point_num, lidar_id, reserved, points); }
};

/// velodyne_msgs/VelodynePacket.
struct VelodynePacket {
  Stamp stamp;  ///< of reception
  FixedBytes<1206> data;
  auto members() { return std::tie(stamp, data); }
};

/// pandar_msgs/PandarPacket, hesai_ros_driver/UdpPacket: `size` bytes of data are used.
struct PandarPacket {
  Stamp stamp;
  FixedBytes<1500> data;
  std::uint32_t size = 0;
  auto members() { return std::tie(stamp, data, size); }
};

/// rslidar_msgs/rslidarPacket, and rslidar_msg/RslidarPacket of drivers before 1.3.
struct RslidarPacket {
  Stamp stamp;
  FixedBytes<1248> data;
  auto members() { return std::tie(stamp, data); }
};

/// rslidar_msg/RslidarPacket of drivers from 1.3 on.
struct RslidarMessage {
  Header header;
  std::uint8_t is_difop = 0, is_frame_begin = 0;
  std::string_view data;
  auto members() { return std::tie(header, is_difop, is_frame_begin, data); }
};

/// velodyne_msgs/VelodyneScan, pandar_msgs/PandarScan, hesai_ros_driver/UdpFrame,
/// rslidar_msgs/rslidarScan.
template <class Packet>
struct PacketScan {
  Header header;
  std::vector<Packet> packets;
  auto members() { return std::tie(header, packets); }
};
using VelodyneScan = PacketScan<VelodynePacket>;
using PandarScan = PacketScan<PandarPacket>;
using RslidarScan = PacketScan<RslidarPacket>;

/// PacketMsg of Ouster's drivers.
struct OusterPacket {
  std::string_view bytes;
  auto members() { return std::tie(bytes); }
};

/// can_msgs/Frame.
struct CanFrame {
  Header header;
  std::uint32_t id = 0;
  std::uint8_t is_rtr = 0, is_extended = 0, is_error = 0;
  std::uint8_t length = 0;  ///< [bytes] of the data that are used
  FixedBytes<8> data;
  auto members() { return std::tie(header, id, is_rtr, is_extended, is_error, length, data); }
};

/// std_msgs/String.
struct Text {
  std::string text;
  auto members() { return std::tie(text); }
};

/// radar_msgs/RadarTrack: an object of a radar's own tracker.
struct RadarTrack {
  std::array<std::uint8_t, 16> id{};
  std::array<double, 3> position{}, velocity{}, acceleration{}, size{};  ///< [m], [s]
  std::uint16_t classification = 0;
  std::array<float, 24> covariances{};  ///< six each: of position, velocity, acceleration, size
  auto members() {
    return std::tie(id, position, velocity, acceleration, size, classification, covariances);
  }
};

struct RadarTracks {
  Header header;
  std::vector<RadarTrack> tracks;
  auto members() { return std::tie(header, tracks); }
};

/// sensor_msgs/LaserScan: ranges of one layer, counter-clockwise where the increment is positive.
struct LaserScan {
  Header header;                                            ///< stamp of the first range
  float angle_min = 0, angle_max = 0, angle_increment = 0;  ///< [rad] from x to y
  float time_increment = 0, scan_time = 0;                  ///< [s] between two ranges, two scans
  float range_min = 0, range_max = 0;                       ///< [m]
  std::vector<float> ranges, intensities;                   ///< [m]; a device's own units, or none
  auto members() {
    return std::tie(header, angle_min, angle_max, angle_increment, time_increment, scan_time,
                    range_min, range_max, ranges, intensities);
  }
};

/// geometry_msgs/PoseWithCovarianceStamped.
struct PoseWithCovarianceStamped {
  Header header;
  Pose pose;
  std::array<double, 36> covariance{};
  auto members() { return std::tie(header, pose, covariance); }
};

/// nav_msgs/Path.
struct Path {
  Header header;
  std::vector<PoseStamped> poses;
  auto members() { return std::tie(header, poses); }
};

}  // namespace perception::ros
