#pragma once
#include <vector>

#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/messages/BagTypes.h"
#include "libperception/interop/bags/ReadingBag.h"
#include "libperception/interop/ros/RosMessages.h"

namespace perception {

// Messages with the packets of devices. All functions throw std::runtime_error.

ros::Header unpackVelodyne(const BagMessage&, std::vector<BagPacket>&);
ros::Header unpackPandar(const BagMessage&, std::vector<BagPacket>&);
ros::Header unpackOuster(const BagMessage&, std::vector<BagPacket>&);
/// RoboSense: scans of packets, and a packet each. Those that say what the device is (DIFOP) are
/// noted and not among the packets.
ros::Header unpackRslidarScan(const BagMessage&, std::vector<BagPacket>&);
ros::Header unpackRslidarPacket(const BagMessage&, std::vector<BagPacket>&);
/// Frames of a CAN bus: can_msgs/Frame, and ros2_socketcan_msgs/FdFrame.
ros::Header unpackCan(const BagMessage&, std::vector<BagPacket>&);
ros::Header unpackCanFd(const BagMessage&, std::vector<BagPacket>&);

// These find the topics that have packets of a known device.
void noteOuster(const BagMessage&, BagContents&);
void noteRslidar(const BagMessage&, BagContents&);
void noteCan(const BagMessage&, BagContents&);
void noteCanFd(const BagMessage&, BagContents&);

}  // namespace perception
