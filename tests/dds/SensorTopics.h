// A recording with a topic of each kind of sensor, as ROS 2 nodes write them.
#pragma once
#include <mrpt/img/CImage.h>
#include <mrpt/io/CMemoryStream.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "libperception/interop/ros/RosDevices.h"
#include "libperception/interop/ros/RosMessages.h"

namespace perception::test {

inline constexpr std::size_t kSensorTopics = 10;
inline constexpr int kSensorSteps = 20;  // at 10 Hz

/// vision_msgs/Detection2D of ROS 2.
struct ImageBox {
  ros::Header header;
  std::vector<ros::ObjectHypothesis> results;
  std::array<double, 5> box{};  ///< [px, px, rad, px, px] center, angle, size
  std::string id;
};
template <class Wire>
void fields(Wire& w, ImageBox& m) {
  w(m.header), w(m.results), w(m.box), w(m.id);
}
struct ImageBoxes {
  ros::Header header;
  std::vector<ImageBox> detections;
};
template <class Wire>
void fields(Wire& w, ImageBoxes& m) {
  w(m.header), w(m.detections);
}

/// Writes messages of one step; all sensors are at the vehicle's frame.
class SensorTopics {
 public:
  explicit SensorTopics(const std::string& path) : writer_(path, "ros2") {}

  void writeStep(int k) {
    header_ = {Stamp{1'500'000'000'000'000'000 + k * 100'000'000LL}, "base_link"};
    writeMotion(k);
    writeImages(k);
    writeRadar(k);
    writeBoxes(k);
  }
  void close() { writer_.close(); }

 private:
  template <class Message>
  void put(const std::string& topic, const std::string& type, const Message& message) {
    const std::string package = type.substr(0, type.find('/')), name = type.substr(type.find('/'));
    const auto [channel, is_new] = channels_.try_emplace(topic, std::uint16_t{0});
    if (is_new)
      channel->second = writer_.addChannel(topic, "cdr", {package + "/msg" + name, "ros2msg", ""});
    writer_.write(channel->second, header_.stamp, ros::encoded(message, ros::Encoding::kCdr));
  }

  void writeMotion(int k) {
    ros::Odometry odometry;
    odometry.header = {header_.stamp, "odom"};
    odometry.child_frame_id = "base_link";
    odometry.pose = ros::messageOf(makePose(0.5 * k, 0.1 * k, 0, 0.01 * k));
    odometry.twist = {5, 0, 0, 0, 0, 0.1};
    put("/odometry", "nav_msgs/Odometry", odometry);
    ros::Imu imu;
    imu.header = header_;
    imu.rates = {0.001 * k, 0, 0.1};
    imu.force = {0.2, 0.01 * k, 9.81};
    put("/imu", "sensor_msgs/Imu", imu);
    ros::NavSatFix fix;
    fix.header = header_;
    fix.latitude = 48.1 + 1e-6 * k;
    fix.longitude = 11.5 + 4e-6 * k;
    fix.altitude = 520;
    fix.covariance = {0.04, 0, 0, 0, 0.04, 0, 0, 0, 0.1};
    fix.covariance_type = 2;
    put("/fix", "sensor_msgs/NavSatFix", fix);
  }

  void writeImages(int k) {
    std::string pixels;
    for (int i = 0; i < 64 * 48 * 3; ++i) pixels += static_cast<char>((i * 7 + 11 * k) & 255);
    ros::Image image;
    image.header = header_;
    image.width = 64;
    image.height = 48;
    image.encoding = "rgb8";
    image.step = 64 * 3;
    image.data = pixels;
    put("/front/image", "sensor_msgs/Image", image);
    mrpt::img::CImage picture(64, 48, mrpt::img::CH_RGB);
    const auto shade = [](int value) { return static_cast<std::uint8_t>(value); };
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 64; ++x)
        picture.setPixel(x, y, mrpt::img::TColor(shade(4 * x), shade(5 * y), shade(9 * k)));
    }
    mrpt::io::CMemoryStream bytes;
    picture.saveToStreamAsJPEG(bytes, 90);
    const std::string jpeg(static_cast<const char*>(bytes.getRawBufferData()),
                           static_cast<std::size_t>(bytes.getTotalBytesCount()));
    ros::CompressedImage compressed;
    compressed.header = header_;
    compressed.format = "jpeg";
    compressed.data = jpeg;
    put("/rear/image", "sensor_msgs/CompressedImage", compressed);
  }

  void writeRadar(int k) {
    ros::RadarScan scan;
    scan.header = header_;
    for (int i = 0; i < 5; ++i)
      scan.returns.push_back({10.0F + static_cast<float>(i), 0.1F * static_cast<float>(i - 2), 0,
                              -4 + 0.1F * static_cast<float>(k), 12});
    put("/radar/scan", "radar_msgs/RadarScan", scan);
    ros::RadarTracks tracks;
    tracks.header = header_;
    for (int i = 0; i < 3; ++i) {
      ros::RadarTrack track;
      track.id[0] = static_cast<std::uint8_t>(i + 1);
      track.position = {20.0 + i, 2.0 * i, 0};
      track.velocity = {-3, 0.1 * k, 0};
      track.size = {4, 2, 1.5};
      tracks.tracks.push_back(track);
    }
    put("/radar/tracks", "radar_msgs/RadarTracks", tracks);
    ros::LaserScan layer;
    layer.header = header_;
    layer.angle_min = -1, layer.angle_max = 1, layer.angle_increment = 0.01F;
    layer.range_min = 0.2F, layer.range_max = 60;
    for (int i = 0; i <= 200; ++i) layer.ranges.push_back(8 + 0.1F * static_cast<float>(i % 7 + k));
    put("/bumper/scan", "sensor_msgs/LaserScan", layer);
  }

  void writeBoxes(int k) {
    ros::ObjectHypothesis car;
    car.class_id = "car", car.score = 0.5 + 0.01 * k;
    ros::Detection3DArray boxes;
    boxes.header = header_;
    for (int i = 0; i < 3; ++i)
      boxes.detections.push_back({header_,
                                  {car},
                                  ros::messageOf(makePose(15.0 + i, 3.0 * i, 0.8, 0.1 * k)),
                                  {4, 2, 1.6},
                                  {}});
    put("/boxes", "vision_msgs/Detection3DArray", boxes);
    ImageBoxes image;
    image.header = header_;
    for (int i = 0; i < 2; ++i)
      image.detections.push_back({header_, {car}, {20.0 + 10 * i, 24.0 + k, 0, 12, 8}, "a"});
    put("/front/boxes", "vision_msgs/Detection2DArray", image);
  }

  McapWriter writer_;
  std::map<std::string, std::uint16_t> channels_;
  ros::Header header_;
};

inline void writeSensorTopics(const std::string& path) {
  SensorTopics topics(path);
  for (int k = 0; k < kSensorSteps; ++k) topics.writeStep(k);
  topics.close();
}

}  // namespace perception::test
