#include "libperception/measurement/models/DetectionModel.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/Error.h"

namespace perception {
namespace {

ClassTable classes() {
  ClassTable table;
  for (const char* name : {"pedestrian", "car", "tram"}) {
    table.classes.emplace_back();
    table.classes.back().name = name;
  }
  return table;
}

const std::vector<std::string> kLidarLabels{"car_sized", "person_sized"};

DetectionModel read(Config& config, const std::vector<std::string>& labels = kLidarLabels) {
  return DetectionModel::read(config, "sensor.A", classes(), labels, {});
}

std::string faultsOf(const std::string& ini) {
  Config config = Config::fromText(ini, "a.ini");
  read(config);
  try {
    config.finish();
  } catch (const ConfigError& e) {
    return e.what();
  }
  return "";
}

const char* const kTables = R"(
[detection.lidar.pedestrian]
detection = 0.88
label.car_sized = 0.10
label.person_sized = 0.85
label.unstable = 0.05
[detection.lidar.car]
detection = 0.91
label.car_sized = 0.45
label.person_sized = 0.03
label.unstable = 0.52
[detection.camera.pedestrian]
detection = 0.70
label.person = 0.98
[detection.camera.car]
detection = 0.85
label.car = 0.98
)";

TEST(DetectionModel, StartsFromTheTableOfItsModality) {
  Config config = Config::fromText("[sensor.A]\nmodality = L\n" + std::string(kTables), "a.ini");
  const DetectionModel s = read(config);
  EXPECT_NEAR(s.detection(0, 10, 0, 1), 0.88, 1e-12);
  EXPECT_NEAR(s.detection(1, 10, 0, 1), 0.91, 1e-12);
  // Two labels: the default rows' shares of a third one are spread over these.
  EXPECT_NEAR(std::exp(s.logLabel(0, 0)), 0.10 / 0.95, 1e-9);
  // A class without a row: P_D .9, every label alike.
  EXPECT_NEAR(s.detection(2, 10, 0, 1), 0.9, 1e-12);
  EXPECT_NEAR(std::exp(s.logLabel(0, 2)), 0.5, 1e-9);
}

TEST(DetectionModel, ItsOwnRowsWinOverTheTableOfItsModality) {
  Config config = Config::fromText(
      "[sensor.A]\nmodality = L\n[sensor.A.class.car]\ndetection = 0.5\n" + std::string(kTables),
      "a.ini");
  const DetectionModel s = read(config);
  EXPECT_NEAR(s.detection(1, 10, 0, 1), 0.5, 1e-12);
  EXPECT_NEAR(std::exp(s.logLabel(0, 1)), 0.45 / 0.48, 1e-9);
}

TEST(DetectionModel, TablesAreOfKnownModalitiesAndClasses) {
  const auto faults = [](const std::string& section) {
    Config config = Config::fromText("[" + section + "]\ndetection = 0.5\n", "a.ini");
    checkDetectionTables(config, classes());
    try {
      config.finish();
    } catch (const ConfigError& e) {
      return std::string(e.what());
    }
    return std::string();
  };
  EXPECT_EQ(faults("detection.radar.tram"), "");
  for (const char* wrong : {"detection.sonar.tram", "detection.radar.horse", "detection.radar"})
    EXPECT_NE(faults(wrong).find("known modality and class"), std::string::npos) << wrong;
}

TEST(DetectionModel, ThePapersPrecisionStandsForTheTableOfLabels) {
  Config config = Config::fromText(
      "[sensor.A]\nmodality = L\nprecision.car_sized = 0.51\nprecision.person_sized = 0.55\n"
      "[sensor.A.class.car]\nlabel.car_sized = 0.9\n"
      "[sensor.A.class.pedestrian]\nlabel.person_sized = 0.9\n",
      "a.ini");
  const DetectionModel s = read(config);
  EXPECT_NEAR(s.logLabel(0, 1), std::log(0.51), 1e-12);
  EXPECT_NEAR(s.logLabel(0, 0), std::log(0.49), 1e-12);
  EXPECT_NEAR(s.logLabel(1, 0), std::log(0.55), 1e-12);
  // [radecki2016]: a car is known after some 74 clusters, a person after 15 (posterior .95).
  EXPECT_NEAR(std::log(19) / (s.logLabel(0, 1) - s.logLabel(0, 0)), 73.6, 0.1);
  EXPECT_NEAR(std::log(19) / (s.logLabel(1, 0) - s.logLabel(1, 1)), 14.7, 0.1);
}

TEST(DetectionModel, PrecisionMustNameEveryLabel) {
  EXPECT_NE(faultsOf("[sensor.A]\nprecision.car_sized = 0.51\n").find("one for each label"),
            std::string::npos);
  EXPECT_NE(faultsOf("[sensor.A]\nprecision.tram = 0.51\n").find("no label of this sensor"),
            std::string::npos);
}

TEST(DetectionModel, RowsSumToOne) {
  Config config =
      Config::fromText("[sensor.A]\n[sensor.A.class.car]\nlabel.car_sized = 0.7\n", "a.ini");
  const DetectionModel s = read(config, {"car_sized", "person_sized", "unstable"});
  for (ClassId c = 0; c < 3; ++c) {
    double sum = 0;
    for (int l = 0; l < 3; ++l) sum += std::exp(s.logLabel(l, c));
    EXPECT_NEAR(sum, 1, 1e-12);
  }
  double clutter = 0;
  for (int l = 0; l < 3; ++l) clutter += std::exp(s.logLabelClutter(l));
  EXPECT_NEAR(clutter, 1, 1e-12);
}

TEST(DetectionModel, ReportsWhatCannotBe) {
  EXPECT_NE(faultsOf("[sensor.A]\n[sensor.A.class.car]\nlabel.huge = 0.7\n").find("label.huge"),
            std::string::npos);
  EXPECT_NE(
      faultsOf("[sensor.A]\n[sensor.A.class.bicycle]\ndetection = 0.7\n").find("no such class"),
      std::string::npos);
  EXPECT_NE(
      faultsOf(
          "[sensor.A]\n[sensor.A.class.tram]\nlabel.car_sized = 0.7\nlabel.person_sized = 0.7\n")
          .find("sum to 1"),
      std::string::npos);
  EXPECT_NE(faultsOf("[sensor.A]\npose = 1, 2, 3, 4, 5\n").find("six numbers"), std::string::npos);
  EXPECT_NE(faultsOf("[sensor.A]\nrange_min = 80\nrange_max = 70\n").find("range_min"),
            std::string::npos);
  EXPECT_EQ(faultsOf("[sensor.A]\npose = 1, 2, 3, 90, 0, 0\n"), "");
}

TEST(DetectionModel, TheResolutionOfAPanoramaSetsItsRanges) {
  Config config = Config::fromText(
      "[sensor.A]\nkind = boxes\nmodality = C\nresolution = 8k\nrange_max = 18\n"
      "[sensor.A.class.pedestrian]\nfull_range = 9\nlast_range = 11\n" +
          std::string(kTables),
      "a.ini");
  checkDetectionTables(config, classes());
  const DetectionModel s =
      DetectionModel::read(config, "sensor.A", classes(), {"car", "person"}, {});
  EXPECT_NO_THROW(config.finish());
  EXPECT_NEAR(s.detection(1, 62, 0, 1), 0.85, 1e-12);  // cars: full to 63 m, to 77 m at most
  EXPECT_EQ(s.detection(1, 78, 0, 1), 0);
  EXPECT_NEAR(s.detection(0, 35, 0, 1), 0.70, 1e-12);  // persons: full to 36 m, to 44 m at most
  EXPECT_EQ(s.detection(0, 45, 0, 1), 0);
  EXPECT_NE(faultsOf("[sensor.A]\nresolution = 8k\n").find("of cameras"), std::string::npos);
}

TEST(DetectionModel, AClassThatIsNeverSeenKeepsALeastProbabilityInView) {
  Config config = Config::fromText(
      "[sensor.A]\nrange_max = 50\n[sensor.A.class.tram]\ndetection = 0\n", "a.ini");
  const DetectionModel s = read(config);
  config.finish();
  EXPECT_EQ(s.detection(2, 10, 0, 1), 0.001);
  EXPECT_EQ(s.detection(2, 10, 0, 0.5), 0.0005) << "half hidden";
  EXPECT_EQ(s.detection(2, 51, 0, 1), 0) << "out of view";
  EXPECT_EQ(s.detection(1, 10, 0, 1), 0.9) << "others are as the tables say";
}

TEST(DetectionModel, FadesAtTheBordersOfItsView) {
  DetectionParams p;
  p.range_min = 2;
  p.range_max = 50;
  p.fov = radians(90);
  const DetectionModel s(p, {{}, {}, {}}, kLidarLabels);
  EXPECT_EQ(s.detection(0, 1, 0, 1), 0);
  EXPECT_EQ(s.detection(0, 50, 0, 1), 0);
  EXPECT_NEAR(s.detection(0, 48.75, 0, 1), 0.45, 1e-9);  // half way between 47.5 m and 50 m
  EXPECT_EQ(s.detection(0, 10, radians(45), 1), 0);
  EXPECT_NEAR(s.detection(0, 10, radians(44), 1), 0.45, 1e-9);
  EXPECT_NEAR(s.detection(0, 10, 0, 0.5), 0.45, 1e-9);
  EXPECT_NEAR(s.area(), 0.5 * radians(90) * (2500 - 4), 1e-9);
}

}  // namespace
}  // namespace perception
