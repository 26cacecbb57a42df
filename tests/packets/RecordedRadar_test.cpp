// Radar messages of recordings against what another decoder made of them.
#include <gtest/gtest.h>

#include <sstream>

#include "tests/packets/Recorded.h"

namespace perception {
namespace {

/// The numbers of every entry of a YAML list, by name ("position.x").
std::vector<std::map<std::string, double>> readEntries(const std::string& path,
                                                       const std::string& list) {
  std::istringstream text(readPossiblyGzipped(path));
  std::vector<std::map<std::string, double>> entries;
  bool inside = false;
  std::string line, group;
  while (std::getline(text, line)) {
    if (line == list + ":") inside = true;
    if (!inside || line.size() < 5) continue;
    if (line.compare(0, 4, "  - ") == 0) entries.emplace_back();
    const auto colon = line.find(':');
    if (colon == std::string::npos || entries.empty()) continue;
    const auto first = line.find_first_not_of(" -");
    const std::string key = line.substr(first, colon - first), value = line.substr(colon + 1);
    if (value.empty()) group = key + ".";
    if (value.empty()) continue;
    entries.back()[(first > 4 ? group : "") + key] = std::atof(value.c_str());
  }
  return entries;
}

void expectTargets(const std::vector<PacketTarget>& targets, const std::string& truth) {
  const auto entries = readEntries(recordedFolder() + truth, "detections");
  ASSERT_EQ(targets.size(), entries.size());
  for (std::size_t i = 0; i < targets.size(); ++i) {
    EXPECT_NEAR(targets[i].range, entries[i].at("range"), 6e-4) << i;
    EXPECT_NEAR(targets[i].azimuth, entries[i].at("azimuth_angle"), 1e-5) << i;
    EXPECT_NEAR(targets[i].range_rate, entries[i].at("range_rate"), 6e-5) << i;
    EXPECT_NEAR(targets[i].rcs, entries[i].at("rcs"), 1e-4) << i;
    if (targets[i].has_elevation) {
      EXPECT_NEAR(targets[i].elevation, entries[i].at("elevation_angle"), 1e-5) << i;
    }
  }
}

TEST(RecordedRadar, Ars548GivesItsDetectionsAndObjects) {
  SKIP_WITHOUT_RECORDINGS();
  const PcapContents contents = readPcap(recordedFolder() + "ars548/packets.pcap.gz");
  ASSERT_EQ(contents.packets.size(), 2U);
  const auto decoder = deviceKind("ars548").make("");
  const DecodedPacket objects = decoder->decode(contents.packets[0].payload);
  const DecodedPacket detections = decoder->decode(contents.packets[1].payload);
  EXPECT_EQ(detections.targets.size(), 308U);
  EXPECT_EQ(detections.stamp_ns, 1708578203955760000);  // 0.25 s before its reception
  EXPECT_TRUE(detections.ends_scan);
  expectTargets(detections.targets, "ars548/truth_detections.yaml.gz");
  const auto truth = readEntries(recordedFolder() + "ars548/truth_objects.yaml.gz", "objects");
  ASSERT_EQ(objects.objects.size(), 50U);
  ASSERT_EQ(truth.size(), 50U);
  double standing = 0;
  int count = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const RadarObject& o = objects.objects[i];
    EXPECT_EQ(o.id, static_cast<std::uint32_t>(truth[i].at("object_id")));
    EXPECT_NEAR(o.x, truth[i].at("position.x"), 6e-4);
    EXPECT_NEAR(o.y, truth[i].at("position.y"), 1e-3);
    EXPECT_NEAR(o.z, truth[i].at("position.z"), 1e-3);
    EXPECT_NEAR(o.yaw, truth[i].at("orientation"), 1e-5);
    EXPECT_NEAR(o.length, truth[i].at("shape_length_edge_mean"), 1e-3);
    EXPECT_NEAR(o.width, truth[i].at("shape_width_edge_mean"), 1e-3);
    if (truth[i].at("status_movement") == 1 && ++count) standing += o.vx;
  }
  // The truth's relative velocity is another field. Ours is that of standing things: the vehicle
  // drives at the rate at which the detections ahead come nearer.
  EXPECT_NEAR(standing / count, -5.75, 0.5);
}

TEST(RecordedRadar, Srr520GivesItsDetectionsAndObjects) {
  SKIP_WITHOUT_RECORDINGS();
  const auto decoder = deviceKind("srr520").make("");
  std::istringstream lines(readPossiblyGzipped(recordedFolder() + "srr520/packets.txt.gz"));
  std::vector<DecodedPacket> lists;
  std::string stamp, hex;
  while (lines >> stamp >> hex) {
    std::string bytes;
    for (std::size_t i = 0; i + 1 < hex.size(); i += 2)
      bytes += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
    const DecodedPacket packet = decoder->decode(bytes);
    if (packet.ends_scan || !packet.objects.empty()) lists.push_back(packet);
  }
  ASSERT_EQ(lists.size(), 3U);
  for (const DecodedPacket& list : lists) {
    if (!list.objects.empty()) {
      const auto truth = readEntries(
          recordedFolder() + "srr520/truth_1708578208_992410284_object.yaml.gz", "objects");
      ASSERT_EQ(list.objects.size(), truth.size());
      EXPECT_EQ(list.stamp_ns, 1708578208992410284);
      for (std::size_t i = 0; i < truth.size(); ++i) {
        EXPECT_EQ(list.objects[i].id, static_cast<std::uint32_t>(truth[i].at("object_id")));
        EXPECT_NEAR(list.objects[i].x, truth[i].at("dist_x"), 1e-3);
        EXPECT_NEAR(list.objects[i].y, truth[i].at("dist_y"), 1e-3);
        EXPECT_NEAR(list.objects[i].vx, truth[i].at("v_abs_x"), 1e-3);
        EXPECT_NEAR(list.objects[i].length, truth[i].at("box_length"), 1e-3);
        EXPECT_NEAR(list.objects[i].yaw, truth[i].at("orientation"), 1e-4);
      }
    } else if (list.stamp_ns == 1708578209045566935) {
      expectTargets(list.targets, "srr520/truth_1708578209_45566935_near_detection.yaml.gz");
    } else {
      EXPECT_EQ(list.stamp_ns, 1708578209076111685);
      expectTargets(list.targets, "srr520/truth_1708578209_76111685_hrr_detection.yaml.gz");
    }
  }
}

}  // namespace
}  // namespace perception
