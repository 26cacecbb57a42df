// All scenarios and vehicles of ini/: they can be read, their trials differ, nobody runs through
// anybody.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <set>

#include "libperception/simulation/world/World.h"
#include "tests/simulation/SceneText.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

const fs::path kIni = fs::path(PERCEPTION_SOURCE_DIR) / "ini";

Scenario read(const fs::path& file) {
  Config config = Config::fromFile(file.string());
  Scenario scenario = readScenario(config);
  config.finish();
  return scenario;
}

std::vector<fs::path> inisOf(const std::string& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kIni / folder)) {
    if (entry.path().extension() == ".ini") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

/// An oriented rectangle on the ground [m].
struct Footprint {
  Vector2 center;
  double heading, length, width;
  std::array<Vector2, 4> corners() const {
    const Vector2 u(std::cos(heading), std::sin(heading)), n(-u.y(), u.x());
    const Vector2 a = .5 * length * u, b = .5 * width * n;
    return {Vector2(center + a + b), Vector2(center + a - b), Vector2(center - a - b),
            Vector2(center - a + b)};
  }
};

// Separating axes of two rectangles.
bool overlap(const Footprint& p, const Footprint& q) {
  if ((p.center - q.center).norm() >
      .5 * (std::hypot(p.length, p.width) + std::hypot(q.length, q.width))) {
    return false;
  }
  const auto a = p.corners(), b = q.corners();
  for (const double heading : {p.heading, q.heading}) {
    for (const Vector2& axis : {Vector2(std::cos(heading), std::sin(heading)),
                                Vector2(-std::sin(heading), std::cos(heading))}) {
      const auto range = [&](const std::array<Vector2, 4>& corners) {
        std::array<double, 2> r{1e18, -1e18};
        for (const Vector2& c : corners) {
          r = {std::min(r[0], axis.dot(c)), std::max(r[1], axis.dot(c))};
        }
        return r;
      };
      const auto x = range(a), y = range(b);
      if (x[1] <= y[0] || y[1] <= x[0]) return false;
    }
  }
  return true;
}

/// Everything that stands or moves on the ground; the last one is the ego.
std::vector<Footprint> footprintsAt(const World& world, double t) {
  std::vector<Footprint> list;
  for (std::size_t i = 0; i < world.objects(); ++i) {
    const ObjectParams& o = world.scenario().objects[i];
    const Pose3 pose = world.object(i, t).T_world_object;
    const bool overhead = o.base > 2;  // crowns of trees
    list.push_back({pose.translation().head<2>(), yawOf(pose), overhead ? 0 : o.length,
                    overhead ? 0 : o.width});
  }
  const Pose3 ego = world.ego(t).T_world_ego;
  constexpr double kFront = 4.2, kRear = 1.3;  // [m] [radecki2016]'s vehicle
  const Vector3 middle = ego * Vector3(.5 * (kFront - kRear), 0, 0);
  list.push_back({middle.head<2>(), yawOf(ego), kFront + kRear, 2.0});
  return list;
}

std::string clash(const World& world) {
  const auto& objects = world.scenario().objects;
  constexpr double kStep = 0.25;  // [s]
  for (double t = 0; t <= world.scenario().params.duration; t += kStep) {
    const auto list = footprintsAt(world, t);
    for (std::size_t i = 0; i < list.size(); ++i) {
      for (std::size_t j = i + 1; j < list.size(); ++j) {
        const bool moves = j == objects.size() || objects[i].waypoints.t.size() > 1 ||
                           objects[j].waypoints.t.size() > 1;
        if (!moves || !overlap(list[i], list[j])) continue;
        return objects[i].name + " and " + (j < objects.size() ? objects[j].name : "the ego") +
               " at " + std::to_string(t) + " s";
      }
    }
  }
  return "";
}

TEST(Scenarios, NobodyRunsThroughAnybodyInAnyTrial) {
  for (const fs::path& file : inisOf("scenarios")) {
    const Scenario scenario = read(file);
    const int trials = scenario.variation.trials;
    for (int trial = 0; trial <= (trials > 1 ? trials : 0); ++trial) {
      const World world(trialOf(scenario, trial, 1));
      EXPECT_EQ(clash(world), "") << file.filename() << ", trial " << trial;
    }
  }
}

TEST(Scenarios, PapersScenariosHaveFiveTrials) {
  for (const char* name : {"A.ini", "B.ini", "C.ini"}) {
    const Scenario scenario = read(kIni / "scenarios" / name);
    EXPECT_EQ(scenario.variation.trials, 5);
    std::set<double> starts;
    std::set<std::uint64_t> seeds;
    for (int trial = 1; trial <= 5; ++trial) {
      starts.insert(trialOf(scenario, trial, 1).ego.waypoints.t.front());
      seeds.insert(trialSeed(1, trial));
    }
    EXPECT_EQ(starts.size(), 5u);
    EXPECT_EQ(seeds.size(), 5u);
  }
}

TEST(Scenarios, TrialIsAFunctionOfItsNumberAndTheSeed) {
  const Scenario scenario = read(kIni / "scenarios/C.ini");
  const Scenario a = trialOf(scenario, 2, 7), b = trialOf(scenario, 2, 7),
                 other = trialOf(scenario, 2, 8);
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    EXPECT_EQ(a.objects[i].waypoints.t, b.objects[i].waypoints.t);
    EXPECT_EQ(a.objects[i].waypoints.x, b.objects[i].waypoints.x);
  }
  EXPECT_NE(a.ego.waypoints.t, other.ego.waypoints.t);
  EXPECT_EQ(trialOf(scenario, 0, 7).ego.waypoints.t, scenario.ego.waypoints.t);
  EXPECT_EQ(trialSeed(7, 0), 7u);
}

TEST(Scenarios, PartyMeetsInEveryTrial) {
  const Scenario scenario = read(kIni / "scenarios/E.ini");
  for (int trial = 1; trial <= scenario.variation.trials; ++trial) {
    const World world(trialOf(scenario, trial, 1));
    double nearest = 1e9;
    for (double t = 0; t < scenario.params.duration; t += 0.05) {
      const Vector3 gap = world.object(0, t).T_world_object.translation() -
                          world.object(1, t).T_world_object.translation();
      nearest = std::min(nearest, gap.norm());
    }
    EXPECT_NEAR(nearest, 0.8, 0.01) << "trial " << trial;
  }
}

TEST(Scenarios, PapersVehicleHasItsSensors) {
  const Scenario scenario = read(kIni / "scenarios/A.ini");
  std::set<std::string> labels;
  int radars = 0;
  for (const SensorParams& s : scenario.sensors) {
    labels.insert(s.label);
    radars += s.kind == SensorKind::kRadar;
  }
  EXPECT_EQ(radars, 8);
  for (const char* label : {"LIDAR_TOP", "IBEO_CENTER", "IBEO_LEFT", "IBEO_RIGHT", "CAMERA_PANO",
                            "RADAR_1", "RADAR_8"}) {
    EXPECT_EQ(labels.count(label), 1u) << label;
  }
}

TEST(Scenarios, VehiclesCanBeRead) {
  for (const fs::path& file : inisOf("vehicles")) {
    Config config = Config::fromFile(file.string());
    config.read<PoseParams>("ego");
    EXPECT_FALSE(readSensors(config).empty()) << file;
    EXPECT_NO_THROW(config.finish()) << file;
  }
}

}  // namespace
}  // namespace perception
