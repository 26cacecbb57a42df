#include "libperception/importers/InputKind.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/interop/bags/McapWriter.h"
#include "tests/importers/ImportFixture.h"

namespace perception {
namespace {

class InputKindOf : public test::ImportRun {
 protected:
  /// What it is and the first command.
  std::string kindOf(const std::string& name) const {
    const auto kind = inputKind(file(name));
    return kind ? kind->what + " | " + kind->commands.at(0) : "rawlog";
  }
  void expectKind(const std::string& name, const std::string& what, const std::string& command) {
    const std::string got = kindOf(name);
    EXPECT_EQ(got.find(what), 0U) << got;
    EXPECT_NE(got.find("| perception-import " + command), std::string::npos) << got;
  }
  std::string scanBytes() const {
    std::vector<float> numbers;
    for (int i = 0; i < 300; ++i)
      numbers.insert(
          numbers.end(),
          {static_cast<float>(20 * std::cos(0.02 * i)), static_cast<float>(12 * std::sin(0.02 * i)),
           static_cast<float>(i % 7) - 1.5F, static_cast<float>(7 * i % 50) / 50});
    return bytesOf(numbers);
  }
};

TEST_F(InputKindOf, RecordingsOfRosAreToldByTheirFirstBytesAndListed) {
  McapWriter writer(file("drive.mcap"), "ros2");
  writer.write(writer.addChannel("/chatter", "cdr", {"std_msgs/msg/String", "ros2msg", ""}),
               Stamp{1'000'000'000}, std::string("\0\1\0\0\3\0\0\0hi\0", 11));
  writer.close();
  expectKind("drive.mcap", "a recording of ROS",
             "bag --bag " + file("drive.mcap") + " -o drive.rawlog");
  const auto kind = inputKind(file("drive.mcap"));
  EXPECT_NE(kind->holds.at(1).find("/chatter"), std::string::npos) << kind->holds.at(1);
  std::filesystem::create_directory(file("bags"));
  std::filesystem::rename(file("drive.mcap"), file("bags/drive_0.mcap"));
  expectKind("bags", "a recording of ROS", "bag --bag " + file("bags"));
}

TEST_F(InputKindOf, KittisLayoutsAreToldFromEachOther) {
  write("tracking/training/velodyne/0003/000000.bin", scanBytes());
  write("tracking/training/calib/0003.txt", "");
  write("tracking/training/oxts/0003.txt", "");
  write("tracking/training/label_02/0003.txt", "");
  const std::string training = file("tracking/training");
  expectKind("tracking", "the KITTI tracking benchmark",
             fmt::format("kitti --calib {0}/calib/0003.txt --lidar {0}/velodyne/0003 --labels "
                         "{0}/label_02/0003.txt --oxts {0}/oxts/0003.txt -o 0003.rawlog",
                         training));
  write("raw/2011_09_26_drive_0001_sync/velodyne_points/data/0000000000.bin", scanBytes());
  write("raw/2011_09_26_drive_0001_sync/oxts/data/0000000000.txt", "");
  expectKind("raw", "a drive of KITTI's raw data", "kitti-raw --dir ");
  write("object/velodyne/000000.bin", scanBytes());
  write("object/calib/000000.txt", "");
  write("object/label_2/000000.txt", "");
  expectKind("object", "single frames of the KITTI object benchmark", "kitti-object --dir ");
  for (const char* part : {"velodyne/000000.bin", "labels/000000.label", "calib.txt", "poses.txt"})
    write(std::string("semantic/dataset/sequences/08/") + part, "");
  expectKind("semantic", "1 sequences of SemanticKITTI", "semantickitti --dir ");
}

TEST_F(InputKindOf, SetsOfWinterAndSprayAreToldByTheirFolders) {
  write("cadc/labeled/lidar_points/data/0000000000.bin", scanBytes());
  write("cadc/labeled/novatel/data/0000000000.txt", "");
  expectKind("cadc", "CADC", "cadc --dir " + file("cadc/labeled") + " -o labeled.rawlog");
  write("boreas/lidar/1611678137000000.bin", scanBytes());
  write("boreas/applanix/lidar_poses.csv", "");
  write("boreas/calib/T_radar_lidar.txt", "");
  expectKind("boreas", "Boreas", "boreas --dir " + file("boreas"));
  write("spray/velodyne/000000.bin", scanBytes());
  write("spray/labels/000000.label", "");
  write("spray/delphi_radar/000000.bin", "");
  expectKind("spray", "SemanticSpray", "semanticspray --dir " + file("spray"));
}

TEST_F(InputKindOf, ScenesOfNuscenesAreListed) {
  write("n/v1.0-mini/scene.json",
        R"([{"token": "s1", "name": "scene-0061", "description": "Rain", "nbr_samples": 3}])");
  expectKind("n", "nuScenes",
             "nuscenes --dir " + file("n") + " --version v1.0-mini --scene scene-0061");
}

TEST_F(InputKindOf, AFolderOrFileOfCloudsSaysItsColumns) {
  write("my scans/0001.bin", scanBytes());
  write("poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n");
  write("my scans/README.txt", "scans of my car\n");
  expectKind("my scans", "a folder of point clouds",
             "clouds --clouds '" + file("my scans") + "' --poses " + file("poses.txt"));
  expectKind("my scans/0001.bin", "a file of a folder of point clouds", "clouds --clouds '");
  const auto kind = inputKind(file("my scans"));
  EXPECT_EQ(kind->holds.at(1), "300 returns, intensities");
  EXPECT_EQ(kind->holds.at(2), "columns found from the data: x y z intensity");
}

TEST_F(InputKindOf, AFileThatIsKnownIsFoundInItsFolderBesideTables) {
  write("ride/manifest.csv", "name,driver\nmonday,anna\n");
  EXPECT_THROW(inputKind(file("ride")), DataError) << "a table is no cloud";
  write("ride/gps/track.gpx", "<?xml version=\"1.0\"?><gpx></gpx>");
  write("ride/gps/notes.csv", "name,driver\nmonday,anna\n");
  const auto kind = inputKind(file("ride"));
  ASSERT_TRUE(kind);
  EXPECT_EQ(kind->what, "a GPX track, in " + file("ride/gps/track.gpx"));
  EXPECT_NE(kind->commands.at(0).find("perception-import gpx --track"), std::string::npos);
}

TEST_F(InputKindOf, TracksOfReceiversAreToldByTheirText) {
  write("way.gpx", "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\"></gpx>\n");
  expectKind("way.gpx", "a GPX track", "gpx --track ");
  write("way.txt", "$GPGGA,123519,4807.038,N\n");
  expectKind("way.txt", "a GPS receiver's NMEA log", "nmea --track ");
  write("u.txt", "L\t0.31\t0.58\t1477010443000000\n");
  expectKind("u.txt", "Udacity", "udacity --measurements ");
}

TEST_F(InputKindOf, TextIsKnownByItsFirstLine) {
  write("udacity/README.txt", "measurements of one object\n");
  write("udacity/sample.txt", "R\t8.46\t0.028\t-3.04\t1477010443399637\t8.6\t0.25\t-3\t0\n");
  expectKind("udacity", "Udacity's radar and laser measurements, in",
             "udacity --measurements " + file("udacity/sample.txt"));
  write("udacity2/spaces.txt", "L 3.12e-01 5.8e-01 1477010443000000 6e-01 6e-01 5.2 0\n");
  expectKind("udacity2", "Udacity's", "udacity --measurements");
  write("walks/README.txt", "L and R are written down\n");
  write("walks/car/a.csv", "t_s,lat_deg,lon_deg\n0,49,8\n1,49,8.0001\n");
  expectKind("walks", "a table of GPS positions", "gpx --track " + file("walks/car/a.csv"));
  write("nmea/track.txt", "$GPGGA,120000,4900.0,N,00824.0,E,1,8,1,110,M,48,M,,*5F\n");
  expectKind("nmea", "a GPS receiver's NMEA log", "nmea --track");
}

TEST_F(InputKindOf, CommonFormatsThatAreNotReadAreNamed) {
  write("flight/a.las", "LASF");
  write("flight/b.las", "LASF");
  for (const char* name : {"flight", "flight/a.las"}) {
    try {
      inputKind(file(name));
      FAIL() << name;
    } catch (const DataError& e) {
      EXPECT_NE(std::string(e.what()).find(".las is not read: save the scans as .pcd"),
                std::string::npos)
          << e.what();
    }
  }
}

TEST_F(InputKindOf, WhatIsNoneOfThemIsRefusedWithTheList) {
  EXPECT_FALSE(inputKind(PERCEPTION_SOURCE_DIR "/rawlogs/demo.rawlog"));
  std::filesystem::create_directory(file("empty"));
  try {
    inputKind(file("empty"));
    FAIL();
  } catch (const DataError& e) {
    EXPECT_EQ(e.code(), ExitCode::kBadInput);
    EXPECT_NE(std::string(e.what()).find(".mcap"), std::string::npos) << e.what();
  }
  EXPECT_THROW(inputKind(file("nothing")), DataError);
}

TEST_F(InputKindOf, RecordingsAsTheyWerePublishedAreKnown) {
  NEEDS_SHARED_DATA("radiate_fog");
  const std::pair<const char*, const char*> all[] = {
      {"radiate_fog", "radiate --dir"},
      {"vod_radar", "vod --dir"},
      {"av2_scans", "av2 --dir"},
      {"aimotive", "aimotive --dir"},
      {"wads_snow", "wads --dir"},
      {"comma2k19_radar", "comma2k19 --dir"},
      {"kitti_tracking", "kitti --calib"},
      {"kitti_object3", "kitti-object --dir"},
      {"kitti_object13", "images --dir"},
      {"udacity_radar_lidar_synth", "udacity --measurements"},
      {"gps_modes", "gpx --track"},
      {"sensor_packets/vlp32c/packets.pcap", "packets --pcap"}};
  for (const auto& [name, command] : all) {
    const auto kind = inputKind(test::sharedData(name));
    ASSERT_TRUE(kind) << name;
    EXPECT_EQ(kind->commands.at(0).find(std::string("perception-import ") + command), 0U)
        << name << ": " << kind->commands.at(0);
  }
}

}  // namespace
}  // namespace perception
