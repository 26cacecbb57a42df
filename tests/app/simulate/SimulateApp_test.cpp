#include "libperception/app/simulate/SimulateApp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "libperception/core/GroundTruth.h"
#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/images/CameraImages.h"
#include "libperception/sensors/rawlog/RawlogReader.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

const std::string kIni = PERCEPTION_SOURCE_DIR "/ini/";

int simulate(SimulateApp& app, const std::vector<std::string>& arguments) {
  std::vector<const char*> argv = {"perception-simulate"};
  for (const std::string& a : arguments) argv.push_back(a.c_str());
  return runApp(app, static_cast<int>(argv.size()), argv.data());
}

std::string bytesOf(const std::string& path) {
  std::ostringstream bytes;
  bytes << std::ifstream(path, std::ios::binary).rdbuf();
  return bytes.str();
}

/// A second of scenario E with a camera alone.
std::vector<std::string> shortScene(const std::string& output) {
  return {"-c",        kIni + "scenarios/E.ini",          "--set", "scenario.duration=1",
          "--vehicle", kIni + "vehicles/camera_only.ini", "-o",    output};
}

TEST(SimulateApp, AnotherVehicleReplacesTheSensors) {
  const test::TemporaryFolder folder;
  SimulateApp app;
  ASSERT_EQ(simulate(app, shortScene(folder / "e.rawlog")), 0);
  EXPECT_EQ(app.out_points, 0u);
  EXPECT_EQ(app.out_targets, 0u);
  EXPECT_GT(app.out_boxes, 0u);
  EXPECT_EQ(app.out_frames, 11);
  EXPECT_EQ(readGroundTruth(folder / "e.truth.csv").instants.size(), 11u);
}

TEST(SimulateApp, WeatherOfAnIniReplacesThatOfTheScenario) {
  const test::TemporaryFolder folder;
  auto arguments = shortScene(folder / "e.rawlog");
  arguments.insert(arguments.end(), {"--weather", kIni + "weather/fog_50.ini"});
  SimulateApp fog;
  ASSERT_EQ(simulate(fog, arguments), 0);
  RawlogReader reader(folder / "e.rawlog");
  std::ostringstream text;
  reader.next()->getDescriptionAsText(text);
  EXPECT_NE(text.str().find("weather: fog 50 m"), std::string::npos) << text.str();
}

TEST(SimulateApp, LabelsOfScansInWeatherLieBesideTheLog) {
  const test::TemporaryFolder folder;
  const auto labelsIn = [&](const std::string& weather) {
    SimulateApp app;
    EXPECT_EQ(simulate(app, {"-c", kIni + "scenarios/demo.ini", "--set", "scenario.duration=0.2",
                             "--weather", kIni + "weather/" + weather, "-o", folder / "d.rawlog"}),
              0);
    std::set<std::uint32_t> classes;
    std::size_t labels = 0;
    std::error_code none;
    for (const auto& file : std::filesystem::directory_iterator(folder / "d_Labels", none)) {
      const std::string bytes = bytesOf(file.path().string());
      std::vector<std::uint32_t> of_frame(bytes.size() / 4);
      std::memcpy(of_frame.data(), bytes.data(), bytes.size());
      labels += of_frame.size(), classes.insert(of_frame.begin(), of_frame.end());
    }
    EXPECT_EQ(labels, app.out_labels > 0 ? app.out_points : 0);
    return classes;
  };
  const auto snow = labelsIn("snow_2.5.ini");
  for (const std::uint32_t label : {10u, 40u, 110u}) EXPECT_EQ(snow.count(label), 1u) << label;
  SimulateApp clear;
  ASSERT_EQ(simulate(clear, {"-c", kIni + "scenarios/demo.ini", "--set", "scenario.duration=0.2",
                             "-o", folder / "d.rawlog"}),
            0);
  EXPECT_TRUE(std::filesystem::is_empty(folder / "d_Labels")) << "those of the snow are gone";
}

TEST(SimulateApp, UnknownKeyOfTheWeatherIsAConfigurationError) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "hail.ini") << "[weather]\nhail_mm_h = 1\n";
  auto arguments = shortScene(folder / "e.rawlog");
  arguments.insert(arguments.end(), {"--weather", folder / "hail.ini"});
  SimulateApp app;
  EXPECT_EQ(simulate(app, arguments), static_cast<int>(ExitCode::kBadConfig));
  EXPECT_FALSE(std::filesystem::exists(folder / "e.rawlog"));
}

TEST(SimulateApp, TrialsDifferAndAreRepeated) {
  const test::TemporaryFolder folder;
  for (const auto& [name, trial] :
       {std::pair("a", "1"), std::pair("b", "1"), std::pair("c", "2")}) {
    auto arguments = shortScene(folder / (std::string(name) + ".rawlog"));
    arguments.insert(arguments.end(), {"--trial", trial});
    SimulateApp app;
    ASSERT_EQ(simulate(app, arguments), 0);
  }
  const std::string a = bytesOf(folder / "a.rawlog");
  EXPECT_FALSE(a.empty());
  EXPECT_TRUE(a == bytesOf(folder / "b.rawlog"));
  EXPECT_FALSE(a == bytesOf(folder / "c.rawlog"));
  EXPECT_NE(bytesOf(folder / "a.truth.csv"), bytesOf(folder / "c.truth.csv"));
}

TEST(SimulateApp, TrialThatTheScenarioHasNotIsAConfigurationError) {
  const test::TemporaryFolder folder;
  auto arguments = shortScene(folder / "e.rawlog");
  arguments.insert(arguments.end(), {"--trial", "6"});
  SimulateApp app;
  EXPECT_EQ(simulate(app, arguments), static_cast<int>(ExitCode::kBadConfig));
  EXPECT_FALSE(std::filesystem::exists(folder / "e.rawlog"));
}

TEST(SimulateApp, DrawsCoverageAndContactSheet) {
  const test::TemporaryFolder folder;
  SimulateApp coverage, sheet;
  EXPECT_EQ(simulate(coverage,
                     {"--coverage", folder / "coverage.png", "-c", kIni + "vehicles/skynet.ini"}),
            0);
  EXPECT_EQ(simulate(sheet, {"--contact-sheet", folder / "sheet.png", kIni + "scenarios/A.ini",
                             kIni + "scenarios/busy_street.ini"}),
            0);
  for (const char* name : {"coverage.png", "sheet.png"}) {
    EXPECT_GT(std::filesystem::file_size(folder / name), 50000u) << name;  // not blank
  }
}

/// The images of a log, decoded.
std::vector<Raster> imagesOf(const std::string& log) {
  std::vector<Raster> images;
  RawlogReader reader(log);
  while (const auto observation = reader.next()) {
    if (!isImage(*observation)) continue;
    const auto raster = std::get<CameraImage>(frameFromObservation(*observation)->data).load();
    if (raster) images.push_back(*raster);
  }
  return images;
}

TEST(SimulateApp, ShippedImagesAreThoseOfTheirScenario) {
  const test::TemporaryFolder folder;
  SimulateApp app;
  ASSERT_EQ(simulate(app, {"-c", kIni + "scenarios/street_images.ini", "--seed", "7", "--set",
                           "scenario.duration=0.1", "-o", folder / "again.rawlog"}),
            0);
  const auto shipped = imagesOf(PERCEPTION_SOURCE_DIR "/rawlogs/camera.rawlog"),
             again = imagesOf(folder / "again.rawlog");
  ASSERT_EQ(shipped.size(), 11u);
  ASSERT_EQ(again.size(), 1u);
  EXPECT_TRUE(panoramaModel(shipped[0].width, shipped[0].height));
  ASSERT_EQ(shipped[0].pixels.size(), again[0].pixels.size());
  double difference = 0;  // another JPEG library may round otherwise
  for (std::size_t i = 0; i < again[0].pixels.size(); ++i)
    difference += std::abs(int{shipped[0].pixels[i]} - int{again[0].pixels[i]});
  EXPECT_LT(difference / static_cast<double>(again[0].pixels.size()), 1);
  const auto truth = readGroundTruth(PERCEPTION_SOURCE_DIR "/rawlogs/camera.truth.csv");
  EXPECT_EQ(truth.instants.size(), 21u);
}

TEST(SimulateApp, NoScenarioIsAUsageError) {
  SimulateApp app;
  EXPECT_EQ(simulate(app, {"-o", "nowhere.rawlog"}), static_cast<int>(ExitCode::kUsage));
}

/// A second of a clear street with one lidar, as a recording.
void record(const test::TemporaryFolder& folder) {
  SimulateApp app;
  ASSERT_EQ(
      simulate(app, {"-c", kIni + "scenarios/E.ini", "--set", "scenario.duration=1", "--vehicle",
                     kIni + "vehicles/kitti.ini", "-o", folder / "clear.rawlog"}),
      0);
}

TEST(SimulateApp, WeatherOnARecordingKeepsItsTruthAndLabelsItsPhantoms) {
  const test::TemporaryFolder folder;
  record(folder);
  const std::vector<std::string> arguments = {
      "weather", "-i", folder / "clear.rawlog", "-c", kIni + "weather/snow_2.5.ini", "-o"};
  std::vector<std::string> first = arguments, again = arguments;
  first.push_back(folder / "snow.rawlog"), again.push_back(folder / "again.rawlog");
  SimulateApp app, twin;
  ASSERT_EQ(simulate(app, first), 0);
  ASSERT_EQ(simulate(twin, again), 0);
  EXPECT_EQ(bytesOf(folder / "snow.rawlog"), bytesOf(folder / "again.rawlog"));
  EXPECT_EQ(bytesOf(folder / "snow.truth.csv"), bytesOf(folder / "clear.truth.csv"));
  EXPECT_GT(app.out_phantoms, app.out_points / 200);
  EXPECT_GT(app.out_labels, 8u);
  EXPECT_TRUE(std::filesystem::exists(folder / "snow_Labels/000003.label"));
  RawlogReader reader(folder / "snow.rawlog");
  std::ostringstream text;
  reader.next()->getDescriptionAsText(text);
  EXPECT_NE(text.str().find("simulated weather on a recording: snow 2.5 mm/h"), std::string::npos);
}

TEST(SimulateApp, FaultyWeatherOnARecordingIsRefused) {
  const test::TemporaryFolder folder;
  record(folder);
  SimulateApp key, itself, missing;
  EXPECT_EQ(
      simulate(key, {"weather", "-i", folder / "clear.rawlog", "-c", kIni + "weather/snow_2.5.ini",
                     "--set", "weather.hail=1", "-o", folder / "x.rawlog"}),
      static_cast<int>(ExitCode::kBadConfig));
  EXPECT_EQ(simulate(itself, {"weather", "-i", folder / "clear.rawlog", "-c",
                              kIni + "weather/snow_2.5.ini", "-o", folder / "clear.rawlog"}),
            static_cast<int>(ExitCode::kUsage));
  EXPECT_EQ(simulate(missing, {"weather", "-i", folder / "none.rawlog", "-c",
                               kIni + "weather/snow_2.5.ini", "-o", folder / "x.rawlog"}),
            static_cast<int>(ExitCode::kNoInput));
  EXPECT_FALSE(std::filesystem::exists(folder / "x.rawlog"));
}

}  // namespace
}  // namespace perception
