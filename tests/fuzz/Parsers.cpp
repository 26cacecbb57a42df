#include "tests/fuzz/Parsers.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <fstream>
#include <memory>
#include <string>

#include "libperception/config/Config.h"
#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/GroundTruth.h"
#include "libperception/core/LaneMap.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/clouds/CloudTable.h"
#include "libperception/importers/clouds/ImportClouds.h"
#include "libperception/importers/kitti/KittiLabels.h"
#include "libperception/importers/kitti/KittiRawFiles.h"
#include "libperception/importers/street_sets/AimotiveFiles.h"
#include "libperception/importers/street_sets/NuscenesTables.h"
#include "libperception/importers/street_sets/VodFiles.h"
#include "libperception/importers/truth/LabeledBoxes.h"
#include "libperception/importers/weather_sets/BoreasFiles.h"
#include "libperception/importers/weather_sets/RadiateFiles.h"
#include "libperception/measurement/objects/ObjectClass.h"
#include "libperception/packets/Decoder.h"
#include "libperception/packets/FrameAssembler.h"
#include "libperception/packets/Pcap.h"
#include "libperception/packets/lidars/Beams.h"
#include "libperception/packets/lidars/Ibeo.h"
#include "libperception/packets/lidars/Ouster.h"
#include "libperception/packets/radars/CanBundle.h"
#include "libperception/sensors/satellites/PositionTrack.h"
#include "tests/fuzz/ParserFiles.h"
#include "tests/packets/Candump.h"

namespace perception {
namespace {

/// The first byte chooses the device.
void decodePackets(std::string_view bytes) {
  if (bytes.empty()) return;
  const auto& kinds = deviceKinds();
  const auto& kind = kinds[static_cast<unsigned char>(bytes[0]) % kinds.size()];
  if (kind.needs_file) return;
  const auto decoder = kind.make("");
  SequenceCounter counter;
  for (int again = 0; again < 2; ++again) counter.count(decoder->decode(bytes.substr(1)));
}

/// An Ouster of 16 beams.
std::string ousterMetadata() {
  std::string altitudes, azimuths;
  for (int i = 0; i < 16; ++i) {
    altitudes += (i > 0 ? "," : "") + std::to_string(15 - 2 * i);
    azimuths += i > 0 ? ",0" : "0";
  }
  const std::string path = written(
      "ouster.json",
      R"({"beam_altitude_angles":[)" + altitudes + R"(],"beam_azimuth_angles":[)" + azimuths +
          R"(],"data_format":{"pixels_per_column":16,"columns_per_frame":1024,"columns_per_packet":16}})");
  return path;
}

/// A device's packets one after the other, as they make its frames: a byte chooses the device, then
/// each packet's length in two bytes (little-endian) and the packet.
void assemblePackets(std::string_view bytes) {
  static const std::string metadata = ousterMetadata();
  if (bytes.empty()) return;
  const auto& kinds = deviceKinds();
  const auto& kind = kinds[static_cast<unsigned char>(bytes[0]) % kinds.size()];
  bytes.remove_prefix(1);
  FrameAssembler assembler(kind, kind.needs_file ? metadata : "", "S", Pose3::Identity(),
                           [](SensorFrame&&) {});
  if (kind.transport == Transport::kCan && bytes.size() % 2 == 1)
    assembler.setTransport(Transport::kCanUdp);
  for (std::int64_t at = 0; bytes.size() >= 2; at += 1000000) {
    const std::size_t length = std::min<std::size_t>(
        static_cast<unsigned char>(bytes[0]) | static_cast<unsigned char>(bytes[1]) << 8,
        bytes.size() - 2);
    assembler.add(bytes.substr(2, length), Stamp{at});
    bytes.remove_prefix(2 + length);
  }
  assembler.finish();
}

/// In two parts; the first byte says where. Each message is decoded.
void cutIbeo(std::string_view bytes) {
  if (bytes.empty()) return;
  const std::size_t first =
      std::min<std::size_t>(static_cast<unsigned char>(bytes[0]), bytes.size());
  IbeoStream stream;
  const auto decoder = deviceKind("ibeo").make("");
  for (const std::string_view part : {bytes.substr(0, first), bytes.substr(first)}) {
    for (const std::string& message : stream.add(part)) {
      try {
        decoder->decode(message);
      } catch (const DataError&) {  // the next one is decoded all the same
      }
    }
  }
}

/// A .bin whose columns are found.
void readNumbers(std::string_view bytes) {
  const std::string path = written("numbers.bin", bytes);
  CloudFormat format;
  format.columns.clear();
  format = foundFormat({path}, format);
  readCloudFile(path, format);
}

void readClasses(std::string_view bytes) {
  Config config = Config::fromText(std::string(bytes), "fuzz.ini");
  readClassTable(config);
  config.finish();
}

void readTrackOf(const std::string& ending, std::string_view bytes) {
  readPositionTrack(written("track." + ending, bytes)).local();
}

/// Tables of nuScenes one behind the other, an empty line between them: those of a drive of one
/// scene, and the drive.
void readNuscenes(std::string_view bytes) {
  for (const char* name :
       {"scene", "sample", "sample_data", "ego_pose", "sensor", "calibrated_sensor",
        "sample_annotation", "instance", "category", "attribute"}) {
    const auto end = std::min(bytes.find("\n\n"), bytes.size());
    written(std::string(name) + ".json", bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 2, bytes.size()));
  }
  for (const NuscenesScene& scene : readNuscenesScenes(scratch()))
    readNuscenesDrive(scratch(), scene);
}

/// A whole importer, but for the end of its log, which waits for the disk.
void import(std::unique_ptr<Importer> importer, const std::string& options) {
  CLI::App cli;
  importer->declare(cli);
  cli.parse(options);
  ImportOptions to;
  to.output = scratch() + "/log.rawlog";
  ImportLog log(to);
  importer->run(log);
}

void importUdacity(std::string_view bytes) {
  import(makeUdacityImporter(), "--measurements " + written("u.txt", bytes));
}

/// Five tables, one behind the other, an empty line between them.
void importComma2k19(std::string_view bytes) {
  for (const char* name : {"gnss_ublox_10hz.csv", "radar_tracks.csv", "pose_20hz_ecef.csv",
                           "ego_speed.csv", "gyro.csv"}) {
    const auto end = std::min(bytes.find("\n\n"), bytes.size());
    written(name, bytes.substr(0, end));
    bytes.remove_prefix(std::min(end + 2, bytes.size()));
  }
  import(makeComma2k19Importer(), "--dir " + scratch());
}

}  // namespace

const std::vector<Parser>& parsers() {
  static const std::vector<Parser> all = {
      {"ini", &readClasses},
      {"csv", [](std::string_view b) { CsvTable::fromText(std::string(b)); }},
      {"truth", ofFile([](const std::string& p) { readGroundTruth(p); })},
      {"lanes", ofFile([](const std::string& p) { LaneMap::fromFile(p); })},
      {"bag", ofFile(&readBag)},
      {"bag_database", &readDatabase},
      {"bag_messages", &readMessage},
      {"bag_fields", &readMessageByFields},
      {"packets", &decodePackets},
      {"packet_frames", &assemblePackets},
      {"candump", [](std::string_view b) { test::candump::parseCandump(b); }},
      {"can_bundle", [](std::string_view b) { parseCanBundle(b); }},
      {"ibeo_stream", &cutIbeo},
      {"pcap", [](std::string_view b) { parsePcap(b, "fuzz.pcap"); }},
      {"ouster", [](std::string_view b) { parseOusterMetadata(std::string(b), "fuzz.json"); }},
      {"beams", ofFile([](const std::string& p) { readBeams(p, 40); })},
      {"kitti_calibration", ofFile([](const std::string& p) { readKittiCalibration(p); })},
      {"kitti_labels", ofFile([](const std::string& p) { readKittiLabels(p); })},
      {"kitti_boxes",
       ofFile([](const std::string& p) { readKittiDetections(p, "boxes3d", "Car"); })},
      {"kitti_oxts", ofFile([](const std::string& p) { readKittiOxts(p); })},
      {"kitti_tracklets", ofFile([](const std::string& p) { readKittiTracklets(p); })},
      {"nuscenes", &readNuscenes},
      {"poses", ofFile([](const std::string& p) { readKittiPoses(p, "kitti"); })},
      {"tum", ofFile([](const std::string& p) { readTumPoses(p); })},
      {"pcd", [](std::string_view b) { readPcd("fuzz.pcd", std::string(b)); }},
      {"ply", [](std::string_view b) { readPly("fuzz.ply", std::string(b)); }},
      {"csv_cloud", [](std::string_view b) { readCsv("fuzz.csv", std::string(b)); }},
      {"npy", [](std::string_view b) { readNpy("fuzz.npy", std::string(b)); }},
      {"npz", ofFile([](const std::string& p) { readNpz(p); })},
      {"vod_radar", ofFile([](const std::string& p) { readVodRadar(p); })},
      {"vod_pose", ofFile([](const std::string& p) { readVodPose(p); })},
      {"cadc_boxes", ofFile([](const std::string& p) { readCadcBoxes(p); })},
      {"spray_boxes", ofFile([](const std::string& p) { readSprayBoxes(p); })},
      {"boreas_boxes", ofFile([](const std::string& p) { readBoreasBoxes(p); })},
      {"boreas_poses", ofFile([](const std::string& p) { readBoreasPoses(p); })},
      {"boreas_transform", ofFile([](const std::string& p) { readBoreasTransform(p); })},
      {"cloud_columns", &readNumbers},
      {"radiate", ofFile([](const std::string& p) { readRadiateAnnotations(p); })},
      {"radiate_times", ofFile([](const std::string& p) { readRadiateTimes(p); })},
      {"aimotive_boxes", ofFile([](const std::string& p) { readAimotiveBoxes(p); })},
      {"aimotive_radar", ofFile([](const std::string& p) { readAimotiveRadar(p); })},
      {"nmea", [](std::string_view b) { readTrackOf("nmea", b); }},
      {"gpx", [](std::string_view b) { readTrackOf("gpx", b); }},
      {"udacity", &importUdacity},
      {"comma2k19", &importComma2k19},
  };
  return all;
}

void parse(const Parser& parser, std::string_view bytes) {
  try {
    parser.run(bytes);
  } catch (const Error&) {  // refused, as it should be
  }
}

}  // namespace perception
