// Messages that are read by the names of their fields. Their bytes are written here, by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/interop/bags/McapWriter.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

constexpr std::int64_t kFieldsBegin = 1'700'000'000'000'000'000;  // [ns]
constexpr double kUnit = 1;                                       // w of a quaternion

/// A message's bytes: CDR (aligned) or as in ROS 1.
class HandWritten {
 public:
  explicit HandWritten(bool cdr) : cdr_(cdr) {
    if (cdr) bytes_.assign("\0\1\0\0", 4);
  }
  template <class Number>
  HandWritten& put(Number value) {
    while (cdr_ && (bytes_.size() - 4) % sizeof(Number) != 0) bytes_ += '\0';
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(Number));
    return *this;
  }
  HandWritten& reals(std::initializer_list<double> values) {
    for (const double value : values) put(value);
    return *this;
  }
  HandWritten& zeros(int count) {
    for (int i = 0; i < count; ++i) put(0.0);
    return *this;
  }
  HandWritten& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + (cdr_ ? 1 : 0)));
    bytes_ += value;
    if (cdr_) bytes_ += '\0';
    return *this;
  }
  HandWritten& count(std::uint32_t n) { return put(n); }
  HandWritten& header(const std::string& frame, std::int64_t after = 0) {
    const std::int64_t ns = kFieldsBegin + after;
    if (!cdr_) put(std::uint32_t{0});
    put(static_cast<std::uint32_t>(ns / 1'000'000'000));
    put(static_cast<std::uint32_t>(ns % 1'000'000'000));
    return text(frame);
  }
  HandWritten& raw(const std::string& data) {
    put(static_cast<std::uint32_t>(data.size()));
    bytes_ += data;
    return *this;
  }
  HandWritten& fixed(const std::string& data) {
    bytes_ += data;
    return *this;
  }
  const std::string& bytes() const { return bytes_; }

 private:
  bool cdr_;
  std::string bytes_;
};
HandWritten cdr() { return HandWritten(true); }
HandWritten ros1() { return HandWritten(false); }

std::string withHeader(const std::string& members) {
  return "Header header\n" + members +
         "================================================================================\n"
         "MSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n";
}

class BagFields : public test::ImportRun {
 protected:
  struct Written {
    std::string topic, type, definition;
    std::vector<std::string> messages;  ///< a tenth of a second apart
  };
  /// 3: the frames have no place on the vehicle.
  void importOf(bool ros2, const std::vector<Written>& topics, const std::string& ini = "") {
    McapWriter writer(file("fields.mcap"), ros2 ? "ros2" : "ros1");
    for (const Written& topic : topics) {
      const auto channel =
          writer.addChannel(topic.topic, ros2 ? "cdr" : "ros1",
                            {topic.type, ros2 ? "ros2msg" : "ros1msg", topic.definition});
      for (std::size_t i = 0; i < topic.messages.size(); ++i)
        writer.write(channel, Stamp{kFieldsBegin + static_cast<std::int64_t>(i) * 100'000'000},
                     topic.messages[i]);
    }
    writer.close();
    std::vector<std::string> words = {"--bag", file("fields.mcap")};
    if (!ini.empty()) {
      write("bag.ini", ini);
      words.insert(words.end(), {"-c", file("bag.ini")});
    }
    const int code = import("bag", words);
    ASSERT_TRUE(code == 0 || code == 3) << code << error_;
  }
  template <class Data>
  Data onlyDataOf(const std::string& label) {
    const auto frames = framesOf(label);
    EXPECT_EQ(frames.size(), 1U) << label << error_;
    return frames.empty() ? Data() : std::get<Data>(frames[0].data);
  }
  /// The boxes of a topic, which are read because the INI names it.
  ObjectDetections boxesOf(const std::string& type, const std::string& definition,
                           const std::string& bytes, bool ros2) {
    importOf(ros2, {{"/boxes", type, definition, {bytes}}}, "[topic./boxes]\nlabel = BOXES\n");
    return onlyDataOf<ObjectDetections>("BOXES");
  }
};

TEST_F(BagFields, APackagesOwnCopyOfPointCloud2IsRead) {
  const std::string floats("\0\0\x80\x3f\0\0\0\x40\0\0\x40\x40", 12);  // 1 2 3
  HandWritten m = cdr();
  m.header("lidar").text("ready").count(1).count(1).count(3);
  std::uint32_t offset = 0;
  for (const char* name : {"x", "y", "z"})
    m.text(name).put(std::exchange(offset, offset + 4)).put(std::uint8_t{7}).count(1);
  m.put(std::uint8_t{0}).count(12).count(12).raw(floats).put(std::uint8_t{1});
  importOf(true, {{"/scan",
                   "our_msgs/msg/Scan",
                   "std_msgs/Header header\nstring state\nsensor_msgs/PointCloud2 cloud\n===\n"
                   "MSG: sensor_msgs/PointCloud2\nuint32 height\nuint32 width\n"
                   "sensor_msgs/PointField[] fields\nbool is_bigendian\nuint32 point_step\n"
                   "uint32 row_step\nuint8[] data\nbool is_dense\n",
                   {m.bytes()}}});
  const auto cloud = onlyDataOf<LidarCloud>("scan");
  ASSERT_EQ(cloud.size(), 1U);
  EXPECT_EQ(cloud.y[0], 2);
}

TEST_F(BagFields, AListOfPointsIsACloudInBothEncodings) {
  for (const bool ros2 : {false, true}) {
    HandWritten m(ros2);
    m.header("lidar").count(2);
    for (const float x : {4.0F, 5.0F})
      m.put(x).put(1.0F).put(-1.0F).put(std::uint8_t{51}).put(std::uint16_t{7});
    importOf(ros2, {{"/scan",
                     ros2 ? "our_msgs/msg/Hits" : "our_msgs/Hits",
                     (ros2 ? "std_msgs/Header header\nHit[] hits\n" : withHeader("Hit[] hits\n")) +
                         "===\nMSG: our_msgs/Hit\nfloat32 x\nfloat32 y\nfloat32 z\n"
                         "uint8 intensity\nuint16 ring\n",
                     {m.bytes()}}});
    const auto cloud = onlyDataOf<LidarCloud>("scan");
    ASSERT_EQ(cloud.size(), 2U);
    EXPECT_EQ(cloud.x[1], 5);
    EXPECT_NEAR(cloud.intensity[1], 0.2, 1e-6) << "bytes have 255 steps";
    EXPECT_EQ(cloud.ring[1], 7);
  }
}

TEST_F(BagFields, PolygonsAndMarkersAreNoClouds) {
  const std::string polygon = ros1().header("map").count(1).put(1.0F).put(2.0F).put(3.0F).bytes();
  McapWriter writer(file("polygon.mcap"), "ros1");
  writer.write(writer.addChannel("/area", "ros1",
                                 {"our_msgs/Area", "ros1msg",
                                  withHeader("Point32[] points\n") +
                                      "===\nMSG: our_msgs/Point32\nfloat32 x\nfloat32 y\n"
                                      "float32 z\n"}),
               Stamp{kFieldsBegin}, polygon);
  writer.close();
  EXPECT_EQ(import("bag", {"--bag", file("polygon.mcap")}), 66) << error_;
  EXPECT_NE(error_.find("our_msgs/Area"), std::string::npos) << error_;
}

TEST_F(BagFields, CloudsOfBeforePointCloud2HaveChannels) {
  HandWritten m = ros1();
  m.header("lidar").count(2);
  for (const float x : {4.0F, 5.0F}) m.put(x).put(1.0F).put(-1.0F);
  m.count(1).text("intensity").count(2).put(0.25F).put(0.5F);
  importOf(false, {{"/old", "sensor_msgs/PointCloud", "", {m.bytes()}}});
  const auto cloud = onlyDataOf<LidarCloud>("old");
  ASSERT_EQ(cloud.size(), 2U);
  EXPECT_EQ(cloud.x[1], 5);
  EXPECT_EQ(cloud.intensity[1], 0.5F);
}

TEST_F(BagFields, AnImageInAMessageIsRead) {
  HandWritten m = ros1();
  m.header("camera").put(1.5).count(1).count(2).text("mono8").put(std::uint8_t{0}).count(2);
  m.raw("\x10\x20");
  importOf(false, {{"/eye",
                    "our_msgs/Exposed",
                    withHeader("float64 exposure\nuint32 height\nuint32 width\nstring encoding\n"
                               "uint8 is_bigendian\nuint32 step\nuint8[] data\n"),
                    {m.bytes()}}});
  const auto image = onlyDataOf<CameraImage>("eye");
  const auto raster = image.load();
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->width, 2);
}

TEST_F(BagFields, PosesOfAnUnknownTypeAreTakenWhereTheIniSaysSo) {
  std::vector<std::string> poses, scans;
  for (int i = 0; i < 5; ++i) {
    poses.push_back(ros1()
                        .header("map", i * 100'000'000)
                        .put(std::uint8_t{2})
                        .reals({1.0 * i, 0, 0, 0, 0, 0, kUnit})
                        .bytes());
    HandWritten scan = ros1();
    scan.header("base_link", i * 100'000'000).count(1).put(9.0F).put(0.0F).put(0.0F).put(0.5F);
    scans.push_back(scan.bytes());
  }
  const std::vector<Written> topics = {
      {"/fix", "our_msgs/Localization", withHeader("uint8 quality\ngeometry_msgs/Pose pose\n"),
       poses},
      {"/scan", "our_msgs/Hits",
       withHeader("Hit[] hits\n") +
           "===\nMSG: our_msgs/Hit\nfloat32 x\nfloat32 y\nfloat32 z\nfloat32 intensity\n",
       scans}};
  importOf(false, topics);
  EXPECT_EQ(result_.poses, 0);
  importOf(false, topics, "[bag]\nposes = /fix\n");
  const auto frames = framesOf("scan");
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_NEAR(frames[3].ego.T_world_ego.translation().x(), 3, 1e-6);
}

TEST_F(BagFields, BoxesInImagesHaveTheirCornersInAllLayouts) {
  const auto result = [](HandWritten& m) {
    m.count(1).text("car").put(0.75).zeros(3 + 3).put(kUnit).zeros(36);
  };
  HandWritten now = cdr();
  now.header("camera").count(1).header("camera");
  result(now);
  now.reals({100, 50, 0, 40, 20}).text("17");
  HandWritten foxy = cdr();
  foxy.header("camera").count(1).header("camera");
  result(foxy);
  foxy.reals({100, 50, 0, 40, 20});
  foxy.header("").count(0).count(0).text("").put(std::uint8_t{0}).count(0).raw("");
  foxy.put(std::uint8_t{0}).text("");
  HandWritten noetic = ros1();
  noetic.header("camera").count(1).header("camera");
  noetic.count(1).put(std::int64_t{3}).put(0.75).zeros(3 + 3).put(kUnit).zeros(36);
  noetic.reals({100, 50, 0, 40, 20});
  noetic.header("").count(0).count(0).text("").put(std::uint8_t{0}).count(0).raw("");
  const std::string noetic_text =
      withHeader("Detection2D[] detections\n") +
      "===\nMSG: vision_msgs/Detection2D\nHeader header\nObjectHypothesisWithPose[] results\n"
      "BoundingBox2D bbox\nsensor_msgs/Image source_img\n"
      "===\nMSG: vision_msgs/ObjectHypothesisWithPose\nint64 id\nfloat64 score\n"
      "geometry_msgs/PoseWithCovariance pose\n"
      "===\nMSG: vision_msgs/BoundingBox2D\ngeometry_msgs/Pose2D center\nfloat64 size_x\n"
      "float64 size_y\n";
  struct Case {
    const char* name;
    std::string definition, bytes, label;
    bool ros2;
  };
  for (const Case& c :
       {Case{"humble", "", now.bytes(), "car", true}, Case{"foxy", "", foxy.bytes(), "car", true},
        Case{"noetic", noetic_text, noetic.bytes(), "3", false}}) {
    SCOPED_TRACE(c.name);
    const auto boxes =
        boxesOf(c.ros2 ? "vision_msgs/msg/Detection2DArray" : "vision_msgs/Detection2DArray",
                c.definition, c.bytes, c.ros2);
    ASSERT_EQ(boxes.objects.size(), 1U);
    ASSERT_TRUE(boxes.objects[0].image_box);
    EXPECT_EQ(boxes.objects[0].image_box->x1, 80);
    EXPECT_EQ(boxes.objects[0].image_box->y2, 60);
    EXPECT_EQ(boxes.objects[0].label, c.label);
    EXPECT_EQ(boxes.objects[0].score, 0.75);
  }
}

TEST_F(BagFields, DetectedAndTrackedObjectsOfAutowareAreBoxes) {
  const auto shape = [](HandWritten& m) {
    m.put(std::uint8_t{0}).count(1).put(1.0F).put(2.0F).put(0.0F).reals({4, 1.8, 1.5});
  };
  const auto pose = [](HandWritten& m) {
    m.reals({10, -2, 1, 0, 0, std::sin(0.25), std::cos(0.25)}).zeros(36);
  };
  HandWritten detected = cdr();
  detected.header("base_link").count(1).put(0.875F);
  detected.count(2).put(std::uint8_t{1}).put(0.25F).put(std::uint8_t{2}).put(0.75F);
  pose(detected);
  detected.put(std::uint8_t{0}).put(std::uint8_t{1}).zeros(6 + 36);
  detected.put(std::uint8_t{1}).put(std::uint8_t{0});
  shape(detected);
  HandWritten tracked = cdr();
  tracked.header("base_link").count(1).fixed(std::string(16, '\7')).put(0.875F);
  tracked.count(1).put(std::uint8_t{2}).put(1.0F);
  pose(tracked);
  tracked.put(std::uint8_t{1}).zeros(6 + 36 + 6 + 36).put(std::uint8_t{0});
  shape(tracked);
  for (const auto& [type, bytes] : std::vector<std::pair<std::string, std::string>>{
           {"autoware_perception_msgs/msg/DetectedObjects", detected.bytes()},
           {"autoware_auto_perception_msgs/msg/TrackedObjects", tracked.bytes()}}) {
    SCOPED_TRACE(type);
    const auto boxes = boxesOf(type, "", bytes, true);
    ASSERT_EQ(boxes.objects.size(), 1U);
    const ObjectDetection& object = boxes.objects[0];
    EXPECT_EQ(object.label, "truck");
    EXPECT_EQ(object.score, 0.875);
    ASSERT_TRUE(object.space_box);
    EXPECT_NEAR(object.space_box->yaw, 0.5, 1e-9);
    EXPECT_NEAR(object.space_box->bottom_center.z(), 0.25, 1e-9);
    EXPECT_EQ(object.space_box->length, 4);
  }
}

TEST_F(BagFields, DerivedObjectsAreBoxesWithAndWithoutThePolygonOfTheirShape) {
  for (const bool polygon : {false, true}) {
    HandWritten m = cdr();
    m.header("base_link").count(1).header("base_link").count(5);
    m.put(std::uint8_t{1}).put(std::uint8_t{1});
    m.reals({20, 3, 0.5, 0, 0, 0, kUnit}).zeros(6 + 6).count(0);
    m.put(std::uint8_t{1}).count(3).reals({4.5, 2, 1});
    if (polygon) m.count(0);
    m.put(std::uint8_t{6}).put(std::uint8_t{51}).count(12);
    const auto boxes = boxesOf("derived_object_msgs/msg/ObjectArray", "", m.bytes(), true);
    ASSERT_EQ(boxes.objects.size(), 1U) << polygon;
    EXPECT_EQ(boxes.objects[0].label, "car");
    EXPECT_NEAR(boxes.objects[0].score, 0.2, 1e-9);
    EXPECT_EQ(boxes.objects[0].space_box->length, 4.5);
    EXPECT_EQ(boxes.objects[0].space_box->bottom_center.z(), 0);
  }
}

TEST_F(BagFields, ObjectsAndClustersOfContinentalsRadarsAreReturns) {
  // At (30, 40), coming with 5 m/s along x: 3 m/s along the line of sight.
  HandWritten clusters = ros1();
  clusters.header("radar").count(1).put(std::int32_t{9});
  clusters.reals({30, 40, 0, 0, 0, 0, kUnit}).zeros(36);
  clusters.reals({-5, 0, 0, 0, 0, 0}).zeros(36).put(6.5);
  HandWritten points = ros1();
  points.header("radar").count(1).put(std::uint8_t{9}).put(30.0F).put(40.0F).put(-5.0F).put(0.0F);
  points.put(6.5F);
  for (const Written& topic :
       {Written{"/r",
                "ars_40X/ClusterList",
                withHeader("Cluster[] clusters\n") +
                    "===\nMSG: ars_40X/Cluster\nint32 id\n"
                    "geometry_msgs/PoseWithCovariance position\n"
                    "geometry_msgs/TwistWithCovariance relative_velocity\nfloat64 rcs\n",
                {clusters.bytes()}},
        Written{"/r",
                "conti_radar/Measurement",
                withHeader("Point[] points\n") +
                    "===\nMSG: conti_radar/Point\nuint8 obstacle_id\nfloat32 longitude_dist\n"
                    "float32 lateral_dist\nfloat32 longitude_vel\nfloat32 lateral_vel\n"
                    "float32 rcs\n",
                {points.bytes()}}}) {
    SCOPED_TRACE(topic.type);
    importOf(false, {topic});
    const auto radar = onlyDataOf<RadarReturns>("r");
    ASSERT_EQ(radar.returns.size(), 1U);
    EXPECT_NEAR(radar.returns[0].range, 50, 1e-4);
    EXPECT_NEAR(radar.returns[0].bearing, std::atan2(40, 30), 1e-6);
    EXPECT_NEAR(radar.returns[0].range_rate, -3, 1e-4);
    EXPECT_NEAR(radar.returns[0].amplitude, 6.5, 1e-6);
    EXPECT_EQ(radar.returns[0].id, 9);
  }
}

TEST_F(BagFields, TracksOfAnEsrMakeAScanWhereTheirNumbersBeginAnew) {
  std::vector<std::string> messages;
  for (int scan = 0; scan < 3; ++scan) {
    for (const int track : {1, 2}) {
      HandWritten m = ros1();
      m.header("esr", scan * 50'000'000).text("500").put(static_cast<std::uint8_t>(track));
      m.put(std::uint8_t{3}).put(10.0F).put(50.0F * static_cast<float>(track)).put(-5.0F);
      messages.push_back(m.bytes());
    }
  }
  importOf(false, {{"/tracks", "delphi_esr_msgs/EsrTrack",
                    withHeader("string canmsg\nuint8 id\nuint8 status\nfloat32 angle\n"
                               "float32 range\nfloat32 range_rate\n"),
                    messages}});
  const auto frames = framesOf("tracks");
  ASSERT_EQ(frames.size(), 2U) << "the last scan ends with the next";
  const auto& returns = std::get<RadarReturns>(frames[0].data).returns;
  ASSERT_EQ(returns.size(), 2U);
  EXPECT_NEAR(returns[1].range, 100, 0.051);
  EXPECT_NEAR(returns[1].bearing, radians(-10), 1e-3) << "clockwise angles";
  EXPECT_NEAR(returns[1].range_rate, -5, 0.006);
}

TEST_F(BagFields, SpeedsInTheVehiclesFrameAreThoseOfWheelsOthersAreLeftOut) {
  const auto twist = [](const std::string& frame) {
    return cdr().header(frame).reals({7, 0, 0, 0, 0, 0.25}).bytes();
  };
  const std::string transform =
      cdr().count(1).header("base_link").text("lidar").reals({0, 0, 1, 0, 0, 0, kUnit}).bytes();
  HandWritten radar = cdr();
  radar.header("base_link").count(1).put(30.0F).put(0.0F).put(0.0F).put(1.0F).put(2.0F);
  importOf(true, {{"/tf_static", "tf2_msgs/msg/TFMessage", "", {transform}},
                  {"/radar", "radar_msgs/msg/RadarScan", "", {radar.bytes()}},
                  {"/speed", "geometry_msgs/msg/TwistStamped", "", {twist("base_link")}},
                  {"/gps/vel", "geometry_msgs/msg/TwistStamped", "", {twist("gps")}}});
  EXPECT_EQ(result_.others["speed"], 1U);
  EXPECT_EQ(result_.others.count("gps_vel"), 0U);
  EXPECT_NE(error_.find("/gps/vel: speeds in frame \"gps\""), std::string::npos) << error_;
}

TEST_F(BagFields, ReceiversOwnMessagesGiveTheirPlaceAboveTheEllipsoid) {
  const auto fix = [](const char* status) {
    return ros1().header("gps").text(status).reals({48.25, 11.5, 500}).put(47.0F).bytes();
  };
  HandWritten radar = ros1();
  radar.header("base_link").count(1).put(30.0F).put(0.0F).put(0.0F).put(1.0F).put(2.0F);
  importOf(false, {{"/bestpos",
                    "novatel_gps_msgs/NovatelPosition",
                    withHeader("string solution_status\nfloat64 lat\nfloat64 lon\n"
                               "float64 height\nfloat32 undulation\n"),
                    {fix("SOL_COMPUTED"), fix("INSUFFICIENT_OBS")}},
                   {"/radar", "radar_msgs/RadarScan", "", {radar.bytes()}}});
  EXPECT_EQ(result_.others["bestpos"], 1U);
}

TEST_F(BagFields, AMessageOfAKnownTypeWithoutAnyDefinitionSaysSo) {
  HandWritten radar = cdr();
  radar.header("base_link").count(1).put(30.0F).put(0.0F).put(0.0F).put(1.0F).put(2.0F);
  importOf(true,
           {{"/zone", "ars_40X/msg/ClusterList", "", {cdr().header("r").bytes()}},
            {"/radar", "radar_msgs/msg/RadarScan", "", {radar.bytes()}}},
           "[topic./radar]\nlabel = R\n");
  EXPECT_NE(error_.find("the recording does not hold the definition of ars_40X/ClusterList"),
            std::string::npos)
      << error_;
}

}  // namespace
}  // namespace perception
