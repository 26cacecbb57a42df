#include "libperception/importers/bags/BagUnpack.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <stdexcept>
#include <string>
#include <string_view>

#include "libperception/importers/messages/MessageFields.h"
#include "libperception/interop/ros/RosDevices.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/lidars/RoboSense.h"
#include "libperception/packets/radars/CanBundle.h"

namespace perception {
namespace {

template <class Message>
Message packetsIn(const BagMessage& m) {
  return ros::decoded<Message>(m.bytes, m.topic->encoding);
}

/// The inertial unit's packets have the same type; they are short.
bool isOfLidar(const ros::OusterPacket& packet) {
  constexpr std::size_t kLongestOfInertialUnit = 64;
  return packet.bytes.size() > kLongestOfInertialUnit;
}

/// Of both layouts that have this name.
ros::RslidarMessage rslidarIn(const BagMessage& m) {
  const std::size_t head = m.topic->encoding == ros::Encoding::kCdr ? 4 : 0;
  if (m.bytes.size() != head + 2 * sizeof(std::uint32_t) + kRoboSenseSize)
    return packetsIn<ros::RslidarMessage>(m);
  const auto packet = packetsIn<ros::RslidarPacket>(m);
  ros::RslidarMessage message;
  message.header = {packet.stamp, "rslidar"};
  message.data = packet.data.bytes;
  return message;
}

/// The model is that of the packet: messages do not say it.
void addRslidar(std::string_view packet, Stamp stamp, std::vector<BagPacket>& packets) {
  if (isDifop(packet)) return;
  const auto model = robosenseModelIn(packet);
  if (!model)
    throw std::runtime_error(
        fmt::format("a packet of {} bytes that is none of RoboSense's RS-LiDAR-16, -32, Helios or "
                    "Bpearl, which are read",
                    packet.size()));
  const int known[] = {kRs16.id, kRs32.id, kBpearl.id, kHeliosId};
  if (std::find(std::begin(known), std::end(known), *model) == std::end(known))
    throw std::runtime_error(
        fmt::format("byte 30 of a packet: model {}, expected {} ({}), {} ({}) or {} ({})", *model,
                    kRs16.id, kRs16.name, kRs32.id, kRs32.name, kBpearl.id, kBpearl.name));
  packets.push_back({std::string(packet), stamp});
}

/// Only frames of a radar that is known make a topic one of a sensor.
template <class Unpack>
void noteDevices(const BagMessage& m, BagContents& contents, Unpack unpack) {
  if (contents.device_topics.count(m.topic->name) != 0) return;
  std::vector<BagPacket> packets;
  unpack(m, packets);
  const BagType* const type = bagType(*m.topic);
  for (const BagPacket& packet : packets) {
    for (const std::string name : type->devices) {
      if (deviceKind(name).make("")->takes(packet.bytes))
        contents.device_topics.insert(m.topic->name);
    }
  }
}
}  // namespace

ros::Header unpackVelodyne(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto scan = packetsIn<ros::VelodyneScan>(m);
  for (const auto& packet : scan.packets)
    packets.push_back({std::string(packet.data.bytes), packet.stamp});
  return scan.header;
}

ros::Header unpackPandar(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto scan = packetsIn<ros::PandarScan>(m);
  for (const auto& packet : scan.packets) {
    if (packet.size > packet.data.bytes.size())
      throw std::runtime_error(fmt::format("a packet of {} bytes, expected at most {}", packet.size,
                                           packet.data.bytes.size()));
    packets.push_back({std::string(packet.data.bytes.substr(0, packet.size)), packet.stamp});
  }
  return scan.header;
}

void noteOuster(const BagMessage& m, BagContents& contents) {
  if (isOfLidar(packetsIn<ros::OusterPacket>(m))) contents.device_topics.insert(m.topic->name);
}

ros::Header unpackOuster(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto packet = packetsIn<ros::OusterPacket>(m);
  if (isOfLidar(packet)) packets.push_back({std::string(packet.bytes), m.stamp});
  return {m.stamp, "os_sensor"};
}

ros::Header unpackRslidarScan(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto scan = packetsIn<ros::RslidarScan>(m);
  for (const auto& packet : scan.packets) addRslidar(packet.data.bytes, packet.stamp, packets);
  return scan.header;
}

void noteRslidar(const BagMessage& m, BagContents& contents) {
  const ros::RslidarMessage packet = rslidarIn(m);
  if (isDifop(packet.data))
    contents.difop.emplace(m.topic->name, packet.data);
  else
    contents.device_topics.insert(m.topic->name);
}

ros::Header unpackRslidarPacket(const BagMessage& m, std::vector<BagPacket>& packets) {
  const ros::RslidarMessage packet = rslidarIn(m);
  addRslidar(packet.data, packet.header.stamp, packets);
  return packet.header;
}

/// A frame of a CAN bus; remote and error frames have no data.
ros::Header unpackCan(const BagMessage& m, std::vector<BagPacket>& packets) {
  const auto frame = packetsIn<ros::CanFrame>(m);
  if (frame.length > frame.data.bytes.size())
    throw std::runtime_error(fmt::format("a CAN frame of {} bytes, expected at most {}",
                                         frame.length, frame.data.bytes.size()));
  if (frame.is_rtr == 0 && frame.is_error == 0)
    packets.push_back(
        {canMessage(frame.id, frame.data.bytes.substr(0, frame.length)), frame.header.stamp});
  return frame.header;
}

ros::Header unpackCanFd(const BagMessage& m, std::vector<BagPacket>& packets) {
  const MessageFields fields = fieldsIn(m);
  const std::string_view data = bytesAt(fields.value, "data");
  const auto size = wholeAt<std::uint8_t>(fields.value, "len");
  if (size > data.size())
    throw std::runtime_error(
        fmt::format("a CAN frame of {} bytes, expected at most {}", size, data.size()));
  const ros::RosValue* const error = fields.value.find("is_error");
  if (error != nullptr && !error->numbers.empty() && error->numbers[0] > 0) return fields.header;
  packets.push_back({canMessage(wholeAt<std::uint32_t>(fields.value, "id"), data.substr(0, size)),
                     fields.header.stamp});
  return fields.header;
}

void noteCan(const BagMessage& m, BagContents& contents) { noteDevices(m, contents, &unpackCan); }
void noteCanFd(const BagMessage& m, BagContents& contents) {
  noteDevices(m, contents, &unpackCanFd);
}

}  // namespace perception
