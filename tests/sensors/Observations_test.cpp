#include <gtest/gtest.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/serialization/CArchive.h>

#include <cstring>
#include <random>
#include <sstream>

#include "libperception/sensors/observations/Conversions.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

std::string serialized(const mrpt::serialization::CSerializable& object) {
  registerPerceptionClasses();
  mrpt::io::CMemoryStream stream;
  mrpt::serialization::archiveFrom(stream).WriteObject(object);
  return {static_cast<const char*>(stream.getRawBufferData()), stream.getTotalBytesCount()};
}

mrpt::serialization::CSerializable::Ptr parsed(const std::string& bytes) {
  mrpt::io::CMemoryStream stream(bytes.data(), bytes.size());
  return mrpt::serialization::archiveFrom(stream).ReadObject();
}

template <class Class>
std::shared_ptr<Class> roundTrip(const Class& object) {
  return std::dynamic_pointer_cast<Class>(parsed(serialized(object)));
}

TEST(CObservationLidarScan, ComesBackBitForBit) {
  const auto scan = fullScan(777);
  const auto back = roundTrip(*scan);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->timestamp, scan->timestamp);
  EXPECT_EQ(back->sensorLabel, "LIDAR_TOP");
  EXPECT_TRUE(toPose3(back->sensor_pose).isApprox(toPose3(scan->sensor_pose), 1e-12));
  EXPECT_EQ(back->cloud.x, scan->cloud.x);
  EXPECT_EQ(back->cloud.y, scan->cloud.y);
  EXPECT_EQ(back->cloud.z, scan->cloud.z);
  EXPECT_EQ(back->cloud.intensity, scan->cloud.intensity);
  EXPECT_EQ(back->cloud.ring, scan->cloud.ring);
  EXPECT_EQ(back->cloud.time_offset, scan->cloud.time_offset);
  EXPECT_EQ(back->cloud.echo, scan->cloud.echo);
  EXPECT_EQ(back->cloud.pulse_width, scan->cloud.pulse_width);
  EXPECT_EQ(back->cloud.label, scan->cloud.label);
  EXPECT_EQ(back->cloud.max_range, 120);
  EXPECT_EQ(serialized(*back), serialized(*scan));
}

TEST(CObservationLidarScan, ArraysThatAreNotThereTakeNoRoom) {
  auto scan = fullScan(1000);
  const std::size_t full = serialized(*scan).size();
  scan->cloud.ring.clear();
  scan->cloud.time_offset.clear();
  const std::size_t less = serialized(*scan).size();
  EXPECT_EQ(full - less, 1000 * (sizeof(std::uint16_t) + sizeof(float)));
  const auto back = roundTrip(*scan);
  EXPECT_TRUE(back->cloud.ring.empty());
  EXPECT_EQ(back->cloud.label, scan->cloud.label);
}

TEST(CObservationLidarScan, RefusesToWriteArraysOfDifferentSize) {
  auto scan = fullScan(10);
  scan->cloud.ring.pop_back();
  EXPECT_THROW(serialized(*scan), std::exception);
}

TEST(CObservationLidarScan, ReadsIntoAnUsedObjectWithoutRemains) {
  auto used = fullScan(50);
  auto plain = fullScan(20);
  plain->cloud.label.clear();
  const std::string bytes = serialized(*plain);
  mrpt::io::CMemoryStream stream(bytes.data(), bytes.size());
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive.ReadObject(used.get());
  EXPECT_EQ(used->cloud.size(), 20U);
  EXPECT_TRUE(used->cloud.label.empty());
}

TEST(CObservationObjectDetections, ComesBackBitForBit) {
  const auto o = someDetections();
  const auto back = roundTrip(*o);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->detections.objects.size(), 2U);
  const ObjectDetection& first = back->detections.objects[0];
  EXPECT_EQ(first.label, "Car");
  EXPECT_EQ(first.score, 8.25);
  EXPECT_EQ(first.class_scores, o->detections.objects[0].class_scores);
  EXPECT_EQ(first.image_box->x2, 110);
  EXPECT_EQ(first.space_box->bottom_center, Vector3(12, 3, -1.7));
  EXPECT_EQ(first.space_box->length, 4.5);
  EXPECT_EQ(first.heading, -1.5);
  EXPECT_FALSE(back->detections.objects[1].space_box);
  EXPECT_FALSE(back->detections.objects[1].heading);
  EXPECT_EQ(back->detections.camera.width, 1242);
  EXPECT_EQ(back->detections.camera.fy, 722.5);
  EXPECT_TRUE(back->detections.T_ego_camera->isApprox(*o->detections.T_ego_camera, 1e-12));
  EXPECT_EQ(serialized(*back), serialized(*o));
}

TEST(CObservationObjectDetections, KnowsAPanoramaFromAPinholeCamera) {
  const auto o = someDetections();
  const std::size_t pinhole = serialized(*o).size();
  o->detections.camera.projection = CameraModel::Projection::kEquirectangular;
  EXPECT_EQ(serialized(*o).size(), pinhole + 1);  // pinhole logs stay as they were
  const auto back = roundTrip(*o);
  EXPECT_EQ(back->detections.camera.projection, CameraModel::Projection::kEquirectangular);
  EXPECT_EQ(back->detections.objects.size(), 2U);
  EXPECT_NE(back->asString().find("equirectangular"), std::string::npos);
}

TEST(CObservationRadarScan, ComesBackBitForBit) {
  const auto o = someReturns();
  ASSERT_TRUE(o);
  const auto back = roundTrip(*o);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->scan.returns.size(), 2U);
  const RadarReturn& first = back->scan.returns[0];
  EXPECT_EQ(first.range, 12.5);
  EXPECT_EQ(first.bearing, -0.2);
  EXPECT_EQ(first.range_rate, -3.25);
  EXPECT_EQ(first.amplitude, 14);
  EXPECT_EQ(first.elevation, 0.02);
  EXPECT_EQ(first.id, 7);
  EXPECT_FALSE(back->scan.returns[1].has_rate);
  EXPECT_FALSE(back->scan.returns[1].elevation);
  EXPECT_EQ(back->scan.max_range, 90);
  EXPECT_EQ(back->sensorLabel, "RADAR_1");
  EXPECT_EQ(serialized(*back), serialized(*o));
}

TEST(Observations, DescriptionAndTextExportNameTheNumbers) {
  EXPECT_NE(fullScan(30)->asString().find("30 points"), std::string::npos);
  EXPECT_NE(fullScan(30)->asString().find("pulse_width"), std::string::npos);
  EXPECT_EQ(fullScan(30)->exportTxtDataRow().substr(0, 6), "30 30 ");
  EXPECT_NE(someDetections()->asString().find("Pedestrian score -0.5000"), std::string::npos);
  EXPECT_NE(someDetections()->exportTxtDataRow().find("2 Car 8.2500 10.00 20.00"),
            std::string::npos);
  for (const mrpt::obs::CObservation::Ptr& o :
       {mrpt::obs::CObservation::Ptr(fullScan(3)), mrpt::obs::CObservation::Ptr(someDetections()),
        mrpt::obs::CObservation::Ptr(someReturns())}) {
    EXPECT_TRUE(o->exportTxtSupported());
    EXPECT_EQ(o->exportTxtDataRow().find('\n'), std::string::npos);
    EXPECT_FALSE(o->exportTxtHeader().empty());
  }
}

/// Peak memory of this process [kB].
long peakMemory() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    long kilobytes = 0;
    if (word == "VmHWM:" && status >> kilobytes) return kilobytes;
  }
  return 0;
}

TEST(Observations, HostileCountsTakeNoMemory) {
  std::string bytes = serialized(*fullScan(5));
  // The count of points stands before the flags (1 byte), the arrays and the end mark (1 byte).
  const std::size_t count_at = bytes.size() - 1 - 5 * (4 * 6 + 2 + 1 + 1) - 1 - 4;
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + count_at, 4);
  ASSERT_EQ(count, 5U);
  const long before = peakMemory();
  for (const std::uint32_t hostile :
       {0xffffffffU, 0x3fffffffU, 0x7fffffffU, 1U << 26, 100'000'000U, 6U}) {
    std::memcpy(bytes.data() + count_at, &hostile, 4);
    EXPECT_THROW(parsed(bytes), std::exception) << hostile;
  }
  EXPECT_LT(peakMemory() - before, 32 * 1024);
}

TEST(Observations, RandomMutationsNeverCrash) {
  std::mt19937 random(20260705);
  const std::string originals[] = {serialized(*fullScan(20)), serialized(*someDetections()),
                                   serialized(*someReturns())};
  int refused = 0;
  for (int round = 0; round < 300; ++round) {
    std::string bytes = originals[round % 3];
    // The class's name stays: other classes are not ours to harden.
    const std::size_t payload = 1 + (static_cast<unsigned char>(bytes[0]) & 0x7fU);
    for (unsigned changes = 1 + random() % 8; changes > 0; --changes) {
      const std::size_t at = payload + random() % (bytes.size() - payload);
      bytes[at] = random() % 4 == 0 ? static_cast<char>(0xff) : static_cast<char>(random());
    }
    try {
      parsed(bytes);
    } catch (const std::exception&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 50);
  EXPECT_LT(refused, 300);
}

TEST(Observations, TruncatedPayloadIsRefusedEverywhere) {
  for (const std::string& whole :
       {serialized(*fullScan(4)), serialized(*someDetections()), serialized(*someReturns())}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      EXPECT_THROW(parsed(whole.substr(0, size)), std::exception) << size;
    }
  }
}

}  // namespace
}  // namespace perception
