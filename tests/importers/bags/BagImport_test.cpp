// The recordings are written here, field by field as ROS defines them.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

#include "libperception/core/math/Random.h"
#include "libperception/interop/bags/McapWriter.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

/// A message as ROS 1 or, aligned and behind four bytes, as CDR.
class Message {
 public:
  explicit Message(bool cdr) : cdr_(cdr) {
    if (cdr) bytes_.assign("\0\1\0\0", 4);
  }
  template <class T>
  Message& put(T value) {
    if (cdr_)
      while ((bytes_.size() - 4) % sizeof value != 0) bytes_.push_back('\0');
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes_.append(raw, sizeof value);
    return *this;
  }
  Message& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + cdr_));
    bytes_ += value;
    if (cdr_) bytes_.push_back('\0');
    return *this;
  }
  Message& header(std::uint32_t second, const std::string& frame) {
    if (!cdr_) put(std::uint32_t{0});  // seq
    return put(second).put(std::uint32_t{500'000'000}).text(frame);
  }
  const std::string& bytes() const { return bytes_; }
  bool cdr() const { return cdr_; }

 private:
  bool cdr_;
  std::string bytes_;
};

/// Two points with three coordinates and one more field.
std::string cloudMessage(bool cdr, std::uint32_t second, const char* fourth = "intensity",
                         bool big_endian = false) {
  Message m(cdr);
  m.header(second, "velodyne").put(std::uint32_t{1}).put(std::uint32_t{2}).put(std::uint32_t{4});
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z", fourth}) {
    m.text(name).put(offset).put(std::uint8_t{7}).put(std::uint32_t{1});
    offset += 4;
  }
  m.put(static_cast<std::uint8_t>(big_endian));
  m.put(std::uint32_t{16}).put(std::uint32_t{32}).put(std::uint32_t{32});
  const float points[] = {10, 1, -1, 0.25F, 20, -2, -1.5F, 0.5F};
  for (const float v : points) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &v, sizeof bits);
    for (int shift = 0; shift < 32; shift += 8)
      m.put(static_cast<std::uint8_t>(bits >> (big_endian ? 24 - shift : shift)));
  }
  m.put(std::uint8_t{1});
  return m.bytes();
}

/// radar_msgs/RadarScan with two returns, the second without a range rate.
std::string radarMessage(bool cdr, std::uint32_t second) {
  Message m(cdr);
  m.header(second, "radar").put(std::uint32_t{2});
  for (const float v : {30.0F, 0.1F, 0.02F, -4.0F, 12.0F}) m.put(v);
  for (const float v : {50.0F, -0.2F, 0.0F, std::nanf(""), 3.0F}) m.put(v);
  return m.bytes();
}

/// A transform without rotation.
std::string transformMessage(bool cdr, std::uint32_t second, const std::string& parent,
                             const std::string& child, const Vector3& at) {
  Message m(cdr);
  m.put(std::uint32_t{1}).header(second, parent).text(child);
  for (int i = 0; i < 3; ++i) m.put(at[i]);
  for (const double q : {0.0, 0.0, 0.0, 1.0}) m.put(q);
  return m.bytes();
}

struct Topic {
  std::string name, type;
  std::vector<std::pair<std::uint32_t, std::string>> messages;  ///< [s], bytes
};

/// A vehicle that drives 2 m in a second, with a lidar 1.8 m above the ground; three scans.
std::vector<Topic> drive(bool cdr) {
  const std::string types = cdr ? "/msg/" : "/";
  Topic clouds{"/points", "sensor_msgs" + types + "PointCloud2", {}};
  Topic moving{"/tf", "tf2_msgs" + types + "TFMessage", {}};
  Topic fixed{"/tf_static", "tf2_msgs" + types + "TFMessage", {}};
  fixed.messages.emplace_back(100,
                              transformMessage(cdr, 100, "base_link", "velodyne", {0.5, 0, 1.8}));
  for (std::uint32_t k = 0; k < 3; ++k) {
    moving.messages.emplace_back(
        100 + k, transformMessage(cdr, 100 + k, "map", "base_link", {2.0 * k, 0, 0}));
    clouds.messages.emplace_back(100 + k, cloudMessage(cdr, 100 + k));
  }
  return {fixed, moving, clouds};
}

template <class T>
std::string raw(T value) {
  return std::string(reinterpret_cast<const char*>(&value), sizeof value);
}
std::string sized(const std::string& bytes) {
  return raw(static_cast<std::uint32_t>(bytes.size())) + bytes;
}
using Fields = std::vector<std::pair<std::string, std::string>>;
std::string record(const Fields& fields, const std::string& data) {
  std::string header;
  for (const auto& [name, value] : fields) header += sized(name + "=" + value);
  return sized(header) + sized(data);
}

/// The messages of one sensor on a vehicle that stands.
std::vector<Topic> standing(bool cdr, const std::string& frame, const Topic& sensor) {
  const std::string types = cdr ? "/msg/" : "/";
  Topic moving{"/tf", "tf2_msgs" + types + "TFMessage", {}};
  Topic fixed{"/tf_static", "tf2_msgs" + types + "TFMessage", {}};
  moving.messages.emplace_back(100, transformMessage(cdr, 100, "map", "base_link", {0, 0, 0}));
  fixed.messages.emplace_back(100, transformMessage(cdr, 100, "base_link", frame, {3.5, 0, 0.5}));
  return {fixed, moving, sensor};
}

/// A ROS 1 bag 2.0 of one chunk.
std::string rosBag(const std::vector<Topic>& topics) {
  std::string chunk;
  std::uint32_t id = 0;
  for (const Topic& topic : topics) {
    std::string data;
    for (const auto& [name, value] : Fields{{"topic", topic.name},
                                            {"type", topic.type},
                                            {"md5sum", "*"},
                                            {"message_definition", ""}})
      data += sized(name + "=" + value);
    chunk += record({{"op", "\x07"}, {"conn", raw(id)}, {"topic", topic.name}}, data);
    for (const auto& [second, bytes] : topic.messages)
      chunk +=
          record({{"op", "\x02"}, {"conn", raw(id)}, {"time", raw(std::uint64_t{second})}}, bytes);
    ++id;
  }
  return "#ROSBAG V2.0\n" +
         record({{"op", "\x03"},
                 {"index_pos", raw(std::uint64_t{4117})},
                 {"conn_count", raw(id)},
                 {"chunk_count", raw(std::uint32_t{1})}},
                std::string(4027, ' ')) +
         record({{"op", "\x05"},
                 {"compression", "none"},
                 {"size", raw(static_cast<std::uint32_t>(chunk.size()))}},
                chunk);
}

class BagImport : public test::ImportRun {
 protected:
  void writeMcap(const std::string& name) { writeMcap(name, drive(true)); }
  void writeMcap(const std::string& name, const std::vector<Topic>& topics) {
    McapWriter writer(file(name), "ros2");
    for (const Topic& topic : topics) {
      const auto channel = writer.addChannel(topic.name, "cdr", {topic.type, "ros2msg", ""});
      for (const auto& [second, bytes] : topic.messages)
        writer.write(channel, Stamp{second * std::int64_t{1'000'000'000}}, bytes);
    }
    writer.close();
  }
  /// The returns of the one scan of a radar with that label.
  RadarReturns returnsOf(const std::string& label) {
    RadarReturns out;
    int scans = 0;
    for (const auto& o : readLog()) {
      if (o->sensorLabel != label) continue;
      const auto frame = frameFromObservation(*o);
      if (!frame || !std::holds_alternative<RadarReturns>(frame->data)) continue;
      EXPECT_NEAR(frame->T_ego_sensor.translation().x(), 3.5, 1e-9);
      out = std::get<RadarReturns>(frame->data), ++scans;
    }
    EXPECT_EQ(scans, 1);
    return out;
  }
  /// Three scans of two returns, where the vehicle was.
  void expectTheDrive() {
    int scans = 0, poses = 0;
    for (const auto& o : readLog()) {
      if (o->sensorLabel == "EGO_POSE") ++poses;
      if (o->sensorLabel != "points") continue;
      const auto frame = frameFromObservation(*o);
      ASSERT_TRUE(frame);
      const auto& cloud = std::get<LidarCloud>(frame->data);
      ASSERT_EQ(cloud.size(), 2U);
      EXPECT_EQ(cloud.x[1], 20);
      EXPECT_EQ(cloud.intensity[1], 0.5F);
      EXPECT_NEAR(frame->T_ego_sensor.translation().z(), 1.8, 1e-9);
      EXPECT_EQ(frame->stamp.ns, (100 + scans) * std::int64_t{1'000'000'000} + 500'000'000);
      ++scans;
    }
    EXPECT_EQ(scans, 3);
    EXPECT_EQ(poses, 3);
  }
};

TEST_F(BagImport, ABagOfRos1GivesScansMountingAndPoses) {
  write("drive.bag", rosBag(drive(false)));
  ASSERT_EQ(import("bag", {"--bag", file("drive.bag")}), 0) << error_;
  expectTheDrive();
}

TEST_F(BagImport, AnMcapFileOfRos2GivesTheSame) {
  writeMcap("drive.mcap");
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 0) << error_;
  expectTheDrive();
}

TEST_F(BagImport, CloudsOfBigEndianNumbersAreRead) {
  std::vector<Topic> topics = drive(true);
  for (auto& [second, bytes] : topics.back().messages)
    bytes = cloudMessage(true, second, "intensity", true);
  writeMcap("drive.mcap", topics);
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 0) << error_;
  expectTheDrive();
}

TEST_F(BagImport, MessagesThatCameTwiceAreLeftOutAndCounted) {
  std::vector<Topic> topics = drive(true);
  for (Topic& topic : topics) {
    const auto once = topic.messages;
    topic.messages.clear();
    for (const auto& message : once) topic.messages.insert(topic.messages.end(), 2, message);
  }
  writeMcap("drive.mcap", topics);
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 0) << error_;
  expectTheDrive();
  EXPECT_EQ(result_.scans, 3);
  EXPECT_EQ(result_.frames, 3);
  EXPECT_EQ(
      result_.notes.back(),
      "points: 3 messages came twice, with the same content and stamp (within 20 ms): left out");
}

TEST_F(BagImport, PosesByAnotherClockAreNotCountedAsWritten) {
  for (const int apart : {-1000, 1000}) {
    std::vector<Topic> topics = drive(true);
    for (auto& [second, bytes] : topics[2].messages) {
      second = static_cast<std::uint32_t>(static_cast<int>(second) + 2000 + apart);
      bytes = cloudMessage(true, second);
    }
    for (auto& [second, bytes] : topics[1].messages) {
      const double x = 2.0 * (second - 100);
      second += 2000;
      bytes = transformMessage(true, second, "map", "base_link", {x, 0, 0});
    }
    writeMcap("drive.mcap", topics);
    EXPECT_EQ(import("bag", {"--bag", file("drive.mcap")}), 3);
    EXPECT_EQ(result_.poses, 0);
    EXPECT_NE(error_.find("poses: none of the 3 of frame \"base_link\" from tf"), std::string::npos)
        << error_;
    std::filesystem::remove(file("out.rawlog"));
  }
}

TEST_F(BagImport, ScansOfOneStampThatDifferAreKept) {
  std::vector<Topic> topics = drive(true);
  topics.back().messages.emplace_back(102, cloudMessage(true, 102, "ring"));
  writeMcap("drive.mcap", topics);
  ASSERT_EQ(import("bag", {"--bag", file("drive.mcap")}), 0) << error_;
  EXPECT_EQ(result_.scans, 4);
}

TEST_F(BagImport, WhatNothingReadsIsNamedWithItsType) {
  std::vector<Topic> topics = drive(true);
  topics.back().name = "/points/draco",
  topics.back().type = "point_cloud_interfaces/msg/Compressed";
  writeMcap("drive.mcap", topics);
  EXPECT_EQ(import("bag", {"--bag", file("drive.mcap")}), 66);
  EXPECT_NE(error_.find("not read: /points/draco: 3 messages of point_cloud_interfaces/Compressed"),
            std::string::npos)
      << error_;
}

TEST_F(BagImport, ARadarScanGivesItsReturnsInBothEncodings) {
  for (const bool cdr : {false, true}) {
    SCOPED_TRACE(cdr ? "ROS 2" : "ROS 1");
    const auto topics = standing(cdr, "radar",
                                 {"/radar/scan",
                                  cdr ? "radar_msgs/msg/RadarScan" : "radar_msgs/RadarScan",
                                  {{100, radarMessage(cdr, 100)}}});
    if (cdr)
      writeMcap("radar.mcap", topics);
    else
      write("radar.mcap", rosBag(topics));
    ASSERT_EQ(import("bag", {"--bag", file("radar.mcap")}), 0) << error_;
    const auto returns = returnsOf("radar_scan").returns;
    ASSERT_EQ(returns.size(), 2U);
    EXPECT_NEAR(returns[0].range, 30, 1e-5);
    EXPECT_NEAR(returns[0].bearing, 0.1, 1e-6);
    EXPECT_NEAR(*returns[0].elevation, 0.02, 1e-6);
    EXPECT_NEAR(returns[0].range_rate, -4, 1e-6);
    EXPECT_NEAR(returns[0].amplitude, 12, 1e-6);
    EXPECT_TRUE(returns[0].has_rate);
    EXPECT_FALSE(returns[1].has_rate);
  }
}

TEST_F(BagImport, PointsWithRangeRatesAreOfARadarUnlessToldOtherwise) {
  const std::string cloud = cloudMessage(true, 100, "doppler_velocity");
  writeMcap("radar.mcap",
            standing(true, "velodyne", {"/radar", "sensor_msgs/msg/PointCloud2", {{100, cloud}}}));
  ASSERT_EQ(import("bag", {"--bag", file("radar.mcap")}), 0) << error_;
  const auto returns = returnsOf("radar").returns;
  ASSERT_EQ(returns.size(), 2U);
  EXPECT_NEAR(returns[0].range, std::sqrt(102.0), 1e-5);
  EXPECT_NEAR(returns[0].bearing, std::atan2(1, 10), 1e-6);
  EXPECT_NEAR(returns[0].range_rate, 0.25, 1e-6);

  write("turned.ini", "[topic./radar]\nrate_scale = -1\n");
  ASSERT_EQ(import("bag", {"--bag", file("radar.mcap"), "-c", file("turned.ini")}), 0) << error_;
  EXPECT_NEAR(returnsOf("radar").returns.at(0).range_rate, -0.25, 1e-6);

  write("lidar.ini", "[topic./radar]\nkind = lidar\n");
  ASSERT_EQ(import("bag", {"--bag", file("radar.mcap"), "-c", file("lidar.ini")}), 0) << error_;
  bool lidar = false;
  for (const auto& o : readLog()) {
    const auto frame = frameFromObservation(*o);
    lidar = lidar || (frame && std::holds_alternative<LidarCloud>(frame->data));
  }
  EXPECT_TRUE(lidar);
}

/// vision_msgs/Detection3DArray of ROS 2 in frame velodyne: a car 10 m ahead, turned by 90 deg.
std::string boxesMessage(std::uint32_t second) {
  Message m(true);
  m.header(second, "velodyne").put(std::uint32_t{1}).header(second, "velodyne");
  m.put(std::uint32_t{2});
  const std::pair<const char*, double> results[] = {{"truck", 0.2}, {"car", 0.7}};
  for (const auto& [name, score] : results) {
    m.text(name).put(score);
    for (const double v : {10.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0}) m.put(v);
    for (int i = 0; i < 36; ++i) m.put(0.0);
  }
  for (const double v : {10.0, 0.0, -1.0, 0.0, 0.0, std::sqrt(0.5), std::sqrt(0.5)}) m.put(v);
  for (const double v : {4.0, 2.0, 1.6}) m.put(v);
  m.text("7");
  return m.bytes();
}

TEST_F(BagImport, BoxesOfADetectorAreReadWhenTheyAreAskedFor) {
  auto topics = drive(true);
  topics.push_back({"/boxes", "vision_msgs/msg/Detection3DArray", {{101, boxesMessage(101)}}});
  writeMcap("boxes.mcap", topics);
  ASSERT_EQ(import("bag", {"--bag", file("boxes.mcap")}), 0) << error_;
  for (const auto& o : readLog()) EXPECT_NE(o->sensorLabel, "boxes");

  write("boxes.ini", "[topic./boxes]\nlabel = boxes3d\n");
  ASSERT_EQ(import("bag", {"--bag", file("boxes.mcap"), "-c", file("boxes.ini")}), 0) << error_;
  int found = 0;
  for (const auto& o : readLog()) {
    if (o->sensorLabel != "boxes3d") continue;
    const auto frame = frameFromObservation(*o);
    ASSERT_TRUE(frame);
    const auto& objects = std::get<ObjectDetections>(frame->data).objects;
    ASSERT_EQ(objects.size(), 1U);
    EXPECT_EQ(objects[0].label, "car");
    EXPECT_NEAR(objects[0].score, 0.7, 1e-9);
    ASSERT_TRUE(objects[0].space_box);
    EXPECT_TRUE(objects[0].space_box->bottom_center.isApprox(Vector3(10, 0, -1.8), 1e-6));
    EXPECT_NEAR(objects[0].space_box->yaw, kPi / 2, 1e-6);
    EXPECT_NEAR(frame->T_ego_sensor.translation().z(), 1.8, 1e-9);
    ++found;
  }
  EXPECT_EQ(found, 1);
}

TEST_F(BagImport, ATornBagKeepsWhatIsWholeAndSaysWhere) {
  write("torn.bag", rosBag(drive(false)) + raw(std::uint32_t{4096}) + "op=");
  EXPECT_EQ(import("bag", {"--bag", file("torn.bag")}), 3);
  EXPECT_NE(error_.find("byte"), std::string::npos) << error_;
  expectTheDrive();
}

TEST_F(BagImport, DamagedBytesAreSaidAndNeverFollowed) {
  writeMcap("drive.mcap");
  std::ostringstream mcap;
  mcap << std::ifstream(file("drive.mcap"), std::ios::binary).rdbuf();
  Rng rng({1, 0, 0, 0});
  std::map<int, int> codes;
  for (const std::string& whole : {rosBag(drive(false)), mcap.str()}) {
    for (int i = 0; i < 150; ++i) {
      std::string damaged = whole;
      for (int k = 0; k < 3; ++k) {
        // Not the padding of a bag's first record.
        auto at = static_cast<std::size_t>(rng.uniform() * static_cast<double>(whole.size()));
        if (whole[at] == ' ') at = whole.size() - 1 - at % 1000;
        damaged[at] = static_cast<char>(256 * rng.uniform());
      }
      write("damaged.bag", damaged);
      ++codes[import("bag", {"--bag", file("damaged.bag")})];
    }
  }
  for (const auto& [code, count] : codes)
    EXPECT_TRUE(code == 0 || code == 3 || code == 65 || code == 66) << code << ": " << count;
  EXPECT_GT(codes[0] + codes[3], 20);
  EXPECT_GT(codes[3] + codes[65], 20);
}

TEST_F(BagImport, PosesOfTransformsThatMoveNothingAreRefused) {
  std::vector<Topic> topics = drive(false);
  topics.erase(topics.begin() + 1);  // /tf
  write("drive.bag", rosBag(topics));
  write("bag.ini", "[bag]\nposes = tf\n");
  EXPECT_EQ(import("bag", {"--bag", file("drive.bag"), "-c", file("bag.ini")}), 78);
  EXPECT_NE(error_.find("no transform of the recording moves \"base_link\", expected none"),
            std::string::npos)
      << error_;
}

TEST_F(BagImport, WhatIsNoRecordingIsRefused) {
  write("text.bag", "hello, this is not a bag");
  EXPECT_EQ(import("bag", {"--bag", file("text.bag")}), 65);
  EXPECT_NE(error_.find("#ROSBAG V2.0"), std::string::npos) << error_;
}

}  // namespace
}  // namespace perception
