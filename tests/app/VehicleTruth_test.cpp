// Another vehicle's GNSS as the truth: simulated encounters with a receiver in both vehicles.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "libperception/app/ImportApp.h"
#include "libperception/app/simulate/SimulateApp.h"
#include "libperception/core/GroundTruth.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

const std::string kScenarios = PERCEPTION_SOURCE_DIR "/ini/scenarios/";

template <class Program>
int run(Program& app, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), app.name());
  std::vector<const char*> argv;
  for (const std::string& a : arguments) argv.push_back(a.c_str());
  return runApp(app, static_cast<int>(argv.size()), argv.data());
}

class VehicleTruth : public testing::Test {
 protected:
  void SetUp() override {
    // Without lidar and camera, which do not matter here.
    std::ofstream(folder_ / "receiver.ini")
        << "[sensor.GNSS]\nkind = gnss\nx = 0.5\nz = 1.8\nrate = 5\nsigma = 1.5\n";
  }

  void simulate(const std::string& scenario, const std::string& log, int seed) const {
    SimulateApp app;
    std::vector<std::string> arguments = {"-c",     kScenarios + scenario, "-o", folder_ / log,
                                          "--seed", std::to_string(seed)};
    if (scenario == "encounter_own.ini")
      arguments.insert(arguments.end(), {"--vehicle", folder_ / "receiver.ini"});
    ASSERT_EQ(run(app, arguments), 0);
  }

  int import(const std::vector<std::string>& more) const {
    ImportApp app;
    std::vector<std::string> arguments = {"vehicle-truth", "--log", folder_ / "own.rawlog", "-o",
                                          folder_ / "gnss.csv"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(app, arguments);
  }

  /// [m] rms of the places in gnss.csv about those of the simulator.
  double error() const {
    const GroundTruth made = readGroundTruth(folder_ / "gnss.csv");
    const GroundTruth truth = readGroundTruth(folder_ / "own.truth.csv");
    EXPECT_EQ(made.instants.size(), truth.instants.size());
    double squares = 0;
    for (std::size_t i = 0; i < made.instants.size(); ++i) {
      EXPECT_EQ(made.instants[i].frame, truth.instants[i].frame);
      squares +=
          (made.instants[i].objects.at(0).position - truth.instants[i].objects.at(0).position)
              .head<2>()
              .squaredNorm() /
          static_cast<double>(made.instants.size());
    }
    return std::sqrt(squares);
  }

  const test::TemporaryFolder folder_;
};

TEST_F(VehicleTruth, OfTwoPlainReceiversErrsByLessThanOneOfTheirFixes) {
  double squares = 0;
  constexpr int kEncounters = 5;
  for (int seed = 1; seed <= kEncounters; ++seed) {
    simulate("encounter_own.ini", "own.rawlog", seed);
    simulate("encounter_other.ini", "other.rawlog", 100 + seed);
    ASSERT_EQ(import({"--track", folder_ / "other.rawlog", "--antenna", "-0.3", "0"}), 0);
    squares += std::pow(error(), 2) / kEncounters;
  }
  std::printf("simulated encounters, fixes of 1.5 m (each axis): truth errs by %.2f m (rms)\n",
              std::sqrt(squares));
  EXPECT_LT(std::sqrt(squares), 1.0);
  EXPECT_GT(std::sqrt(squares), 0.2);
}

TEST_F(VehicleTruth, OfAFileThatIsAnHourOffSaysByHowMuch) {
  simulate("encounter_own.ini", "own.rawlog", 1);
  std::ofstream csv(folder_ / "other.csv");
  csv << "t_s,lat_deg,lon_deg\n";
  const double start = 1577836800 + 3600;
  for (int i = 0; i < 20; ++i)
    csv << std::to_string(start + i) << ",42.4440," << std::to_string(-76.5019 + 1e-5 * i) << "\n";
  csv.close();
  testing::internal::CaptureStderr();
  EXPECT_EQ(import({"--track", folder_ / "other.csv"}), 65);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("its times run from 3600.0 to 3619.0 s of the log"), std::string::npos)
      << said;
  EXPECT_EQ(import({"--track", folder_ / "other.csv", "--time-offset", "-3600"}), 0);
}

TEST_F(VehicleTruth, WithoutGnssOfTheOwnVehicleIsRefused) {
  SimulateApp app;
  ASSERT_EQ(run(app, {"-c", kScenarios + "E.ini", "--set", "scenario.duration=1", "--vehicle",
                      PERCEPTION_SOURCE_DIR "/ini/vehicles/camera_only.ini", "-o",
                      folder_ / "own.rawlog"}),
            0);
  testing::internal::CaptureStderr();
  EXPECT_EQ(import({"--track", folder_ / "own.rawlog"}), 65);
  EXPECT_NE(testing::internal::GetCapturedStderr().find("no GNSS of the own vehicle"),
            std::string::npos);
}

}  // namespace
}  // namespace perception
