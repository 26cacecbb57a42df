#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>

#include "libperception/core/GroundTruth.h"
#include "libperception/radar/RadarFrontEnd.h"
#include "tests/importers/ImportFixture.h"

// Recordings as they were published: import, and what only fits when every frame is right.

namespace perception {
namespace {

namespace fs = std::filesystem;

using test::sharedData;

class RealImport : public test::ImportRun {};

// ------------------------------------------------------------------------------- View of Delft

/// Distance [m] of a point from a box's footprint; 0 inside.
double distanceFrom(const TruthObject& box, const Vector2& p) {
  const Vector2 d =
      rotate2(-box.yaw, p - box.position.head<2>()).cwiseAbs() - Vector2(box.length, box.width) / 2;
  return d.cwiseMax(0).norm();
}

TEST_F(RealImport, VodsRadarReturnsLieOnWhatIsLabeled) {
  NEEDS_SHARED_DATA("vod_radar");
  ASSERT_EQ(import("vod", {"--dir", sharedData("vod_radar")}), 0) << error_;
  EXPECT_EQ(result_.points, 356860u);
  EXPECT_EQ(result_.radar_returns, 674u);
  const auto truth = readGroundTruth(file("out.truth.csv"));
  const auto scans = framesOf("RADAR_FRONT");
  ASSERT_EQ(scans.size(), truth.instants.size());
  int labeled = 0, seen = 0, moving = 0;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    std::map<std::int64_t, int> of;
    for (const RadarReturn& r : std::get<RadarReturns>(scans[k].data).returns) {
      const double e = r.elevation.value_or(0);
      const Vector3 p = scans[k].T_world_sensor() *
                        (r.range * Vector3(std::cos(e) * std::cos(r.bearing),
                                           std::cos(e) * std::sin(r.bearing), std::sin(e)));
      for (const TruthObject& o : truth.instants[k].objects)
        of[o.id] += distanceFrom(o, p.head<2>()) < 0.5 ? 1 : 0;
    }
    for (const TruthObject& o : truth.instants[k].objects) {
      ++labeled;
      if (of[o.id] > 0) ++seen;
      if (of[o.id] > 0 && !o.ignore) ++moving;
    }
  }
  RecordProperty("labeled", labeled);
  RecordProperty("with_returns", seen);
  RecordProperty("road_users_with_returns", moving);
  EXPECT_EQ(labeled, 39);
  EXPECT_GE(seen, 34);  // the data's README: 15 of 15 and 19 of 24 or 23, with a margin of its own
}

/// Of the labeled road users that count, how many have an object within 2 m.
std::pair<int, int> found(const GroundTruth& truth, const std::vector<Scene>& scenes) {
  int all = 0, near = 0;
  for (const auto& instant : truth.instants) {
    const auto scene = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const Scene& s) { return s.frame == instant.frame; });
    if (scene == scenes.end()) continue;
    for (const TruthObject& o : instant.objects) {
      const double range = (o.position - scene->ego.T_world_ego.translation()).head<2>().norm();
      if (o.ignore || o.occluded > 2 || range > 50) continue;
      ++all;
      near += std::any_of(scene->objects.begin(), scene->objects.end(), [&](const auto& object) {
        return (object.position - o.position).template head<2>().norm() < 2;
      });
    }
  }
  return {near, all};
}

TEST_F(RealImport, VodsRoadUsersAreTracked) {
  NEEDS_SHARED_DATA("vod_radar");
  ASSERT_EQ(import("vod", {"--dir", sharedData("vod_radar"), "--repeat", "10"}), 0) << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  const auto lidar = found(truth, track("vod.ini", "L"));
  const auto radar = found(truth, track("vod.ini", "R"));
  RecordProperty("lidar", std::to_string(lidar.first) + " of " + std::to_string(lidar.second));
  RecordProperty("radar", std::to_string(radar.first) + " of " + std::to_string(radar.second));
  EXPECT_EQ(lidar.second, 16);
  EXPECT_GE(lidar.first, 14);  // measured: 15
  EXPECT_GE(radar.first, 7);   // measured: 8; radar alone starts what moves
}

// ----------------------------------------------------------------------------------- comma2k19

TEST_F(RealImport, Comma2k19sStillObjectsCloseAtOwnSpeed) {
  NEEDS_SHARED_DATA("comma2k19_radar");
  ASSERT_EQ(import("comma2k19", {"--dir", sharedData("comma2k19_radar")}), 0) << error_;
  EXPECT_EQ(result_.radar_returns, 10100u);
  EXPECT_EQ(result_.radar_scans, 1200);
  ObjectClass car;
  car.name = "car";
  car.motion = findMotionModel("wheeled");
  const ClassTable classes{{car}};
  DetectionParams view;
  view.modality = Modality::kRadar;
  view.range_max = 200, view.fov = radians(60);
  const RadarFrontEnd front_end({}, classes, DetectionModel(view, {{}}, {"target"}));
  double sum = 0, square = 0;
  int n = 0;
  for (const SensorFrame& scan : framesOf("RADAR_FRONT")) {
    for (const Measurement& m : front_end.extract(scan).measurements) {
      const double over_ground = groundSpeed(m, {scan.stamp, scan.T_world_sensor(), scan.ego}).mean;
      if (std::abs(over_ground) > 2) continue;  // what drives, drives faster
      sum += over_ground, square += over_ground * over_ground, ++n;
    }
  }
  ASSERT_GT(n, 1000);
  RecordProperty("still_returns", n);
  RecordProperty("mean_mps", std::to_string(sum / n));
  RecordProperty("rms_mps", std::to_string(std::sqrt(square / n)));
  // Own speed is 8 to 20 m/s; range rates are a hundredth of it short (a nose that pointed 7.6 deg
  // below the path, as the import once had it, hid that: its cosine is .991).
  EXPECT_LT(std::abs(sum / n), 0.2);
  EXPECT_LT(std::sqrt(square / n), 0.4);
}

/// [deg] Mean of how far the vehicle's nose points above its path, where it moves.
double noseAbovePath(const std::vector<SensorFrame>& frames) {
  constexpr std::size_t kReach = 10;  // frames to both sides
  double sum = 0;
  int n = 0;
  for (std::size_t i = kReach; i + kReach < frames.size(); ++i) {
    const Vector3 way = frames[i + kReach].ego.T_world_ego.translation() -
                        frames[i - kReach].ego.T_world_ego.translation();
    if (way.head<2>().norm() < 5) continue;
    const Vector3 nose = frames[i].ego.T_world_ego.linear().col(0);
    sum += degrees(std::asin(nose.z()) - std::atan2(way.z(), way.head<2>().norm()));
    ++n;
  }
  EXPECT_GT(n, 20);
  return sum / n;
}

TEST_F(RealImport, TheVehiclePointsAlongItsPath) {
  NEEDS_SHARED_DATA("comma2k19_radar");
  ASSERT_EQ(import("comma2k19", {"--dir", sharedData("comma2k19_radar")}), 0) << error_;
  const double comma = noseAbovePath(framesOf("RADAR_FRONT"));
  RecordProperty("comma2k19_deg", std::to_string(comma));
  EXPECT_NEAR(comma, 0, 0.3);
  const std::string kitti = sharedData("kitti_tracking");
  ASSERT_EQ(import("kitti", {"--calib", kitti + "/calib/0000.txt", "--poses",
                             kitti + "/velo_poses/0000.txt", "--rate", "9.66", "--detections",
                             "rrc:Car=" + kitti + "/det_rrc/Car/0000.txt"}),
            0)
      << error_;
  const double lidar = noseAbovePath(framesOf("rrc"));
  RecordProperty("kitti_deg", std::to_string(lidar));
  EXPECT_NEAR(lidar, 0, 0.7);
}

TEST_F(RealImport, Comma2k19sTrafficIsTracked) {
  NEEDS_SHARED_DATA("comma2k19_radar");
  ASSERT_EQ(import("comma2k19", {"--dir", sharedData("comma2k19_radar"), "--last", "399"}), 0)
      << error_;
  const auto scenes = track("comma2k19.ini", "R");
  ASSERT_EQ(scenes.size(), 400u);
  std::map<std::uint64_t, int> scans_of;
  for (const Scene& scene : scenes) {
    for (const auto& object : scene.objects) {
      ++scans_of[object.id];
      constexpr ClassId kCyclist = 1;
      EXPECT_FALSE(object.classified && object.class_id == kCyclist)
          << "a highway; " << object.speed << " m/s";
    }
  }
  const auto lasting = std::count_if(scans_of.begin(), scans_of.end(),
                                     [](const auto& entry) { return entry.second > 100; });
  EXPECT_GE(lasting, 4);  // more than 5 of the 20 s
}

// ------------------------------------------------------------------------------------- RADIATE

TEST_F(RealImport, RadiatesGpsClockIsFoundByItsLidarAndTheBusStandsStill) {
  NEEDS_SHARED_DATA("radiate_fog");
  // 3: its own list of times leaves out 17 scans, and the GPS clock was set back for a moment.
  ASSERT_EQ(import("radiate", {"--dir", sharedData("radiate_fog")}), 3) << error_;
  EXPECT_EQ(result_.scans, 42);
  EXPECT_EQ(result_.radar_scans, 18);
  EXPECT_EQ(result_.images, 50);
  std::vector<Vector2> places;
  for (const auto& instant : readGroundTruth(file("out.truth.csv")).instants) {
    for (const auto& o : instant.objects) {
      if (o.type == "Bus" && o.frame > 2) places.push_back(o.position.head<2>());
    }
  }
  ASSERT_GE(places.size(), 15u);
  Vector2 mean = Vector2::Zero();
  for (const auto& p : places) mean += p / static_cast<double>(places.size());
  double square = 0;
  for (const auto& p : places) square += (p - mean).squaredNorm();
  const double rms = std::sqrt(square / static_cast<double>(places.size()));
  RecordProperty("bus_rms_m", std::to_string(rms));
  EXPECT_LT(rms, 1.0);  // the vehicle drives 40 m meanwhile; 1.7 m where both clocks begin at once
}

// ------------------------------------------------------------------------------------- Udacity

TEST_F(RealImport, UdacitysObjectIsTrackedWithinTheExercisesBars) {
  NEEDS_SHARED_DATA("udacity_radar_lidar_synth");
  ASSERT_EQ(
      import("udacity", {"--measurements", sharedData("udacity_radar_lidar_synth/"
                                                      "obj_pose-laser-radar-synthetic-input.txt")}),
      0)
      << error_;
  const auto truth = readGroundTruth(file("out.truth.csv"));
  ASSERT_EQ(truth.instants.size(), 500u);
  std::map<std::int64_t, const TruthObject*> of;
  for (const auto& instant : truth.instants) of[instant.frame] = &instant.objects.at(0);
  Vector4 square = Vector4::Zero();
  int n = 0;
  for (const Scene& scene : track("udacity.ini", "L+R")) {
    if (scene.objects.empty() || !of.count(scene.frame)) continue;
    const auto best =
        std::max_element(scene.objects.begin(), scene.objects.end(),
                         [](const auto& a, const auto& b) { return a.existence < b.existence; });
    const TruthObject& o = *of[scene.frame];
    const Vector4 error(best->position.x() - o.position.x(), best->position.y() - o.position.y(),
                        best->velocity.x() - o.vx, best->velocity.y() - o.vy);
    square += error.cwiseAbs2();
    ++n;
  }
  const Vector4 rms = (square / n).cwiseSqrt();
  EXPECT_GE(n, 499);
  RecordProperty("rms", std::to_string(rms[0]) + " " + std::to_string(rms[1]) + " " +
                            std::to_string(rms[2]) + " " + std::to_string(rms[3]));
  // The exercise's own passing marks for x, y [m], vx, vy [m/s].
  EXPECT_LE(rms[0], 0.11);
  EXPECT_LE(rms[1], 0.11);
  EXPECT_LE(rms[2], 0.52);
  EXPECT_LE(rms[3], 0.52);
}

// --------------------------------------------------------------------- snow, single images, GPS

TEST_F(RealImport, SnowIsCountedByLabel) {
  NEEDS_SHARED_DATA("wads_snow");
  ASSERT_EQ(import("wads", {"--dir", sharedData("wads_snow"), "--last", "42224"}), 0) << error_;
  EXPECT_EQ(result_.scans, 2);
  EXPECT_EQ(result_.poses, 2);
  EXPECT_TRUE(fs::exists(file("out_Labels/042224.label.gz")));
  EXPECT_TRUE(std::any_of(result_.notes.begin(), result_.notes.end(), [](const auto& note) {
    return note.rfind("label 110 (falling snow): ", 0) == 0;
  }));
  NEEDS_SHARED_DATA("snowykitti");
  ASSERT_EQ(import("snowykitti", {"--dir", sharedData("snowykitti")}), 0) << error_;
  EXPECT_EQ(result_.scans, 6);
  EXPECT_EQ(result_.points, 581216u);
}

TEST_F(RealImport, LabeledBoxesGiveTracksOfCarsInSingleImages) {
  NEEDS_SHARED_DATA("kitti_object13");
  ASSERT_EQ(
      import("images", {"--dir", sharedData("kitti_object13"), "--label-boxes", "--repeat", "10"}),
      0)
      << error_;
  EXPECT_EQ(result_.images, 13);
  EXPECT_EQ(result_.truth_types.at("Car"), 42u);
  const auto scenes = track("kitti_object.ini", "C");
  ASSERT_EQ(scenes.size(), 130u);
  // Near ones: at a distance the ground's slope decides where an image box stands.
  int near = 0, tracked = 0;
  for (const auto& instant : readGroundTruth(file("out.truth.csv")).instants) {
    const auto scene = std::find_if(scenes.begin(), scenes.end(),
                                    [&](const Scene& s) { return s.frame == instant.frame; });
    ASSERT_NE(scene, scenes.end());
    for (const TruthObject& o : instant.objects) {
      const double range = (o.position - scene->ego.T_world_ego.translation()).head<2>().norm();
      if (o.type != "Car" || o.occluded > 1 || o.truncated > 0.3 || !(range < 20)) continue;
      ++near;
      tracked += std::any_of(scene->objects.begin(), scene->objects.end(), [&](const auto& object) {
        return (object.position - o.position).template head<2>().norm() < 2;
      });
    }
  }
  RecordProperty("near", near);
  RecordProperty("tracked", tracked);
  ASSERT_GE(near, 5);
  EXPECT_GE(tracked, (7 * near + 9) / 10);
}

TEST_F(RealImport, ARidersReceiverIsFollowedAllTheWay) {
  const std::string track_file = "gps_modes/cyclist/cyclist_u020_20111105T075439Z.csv";
  NEEDS_SHARED_DATA(track_file);
  ASSERT_EQ(import("gpx", {"--track", sharedData(track_file), "--as-object"}), 0) << error_;
  EXPECT_EQ(result_.detections.at("GPS_OBJECT"), 1201u);
  const auto scenes = track("gps_object.ini", "L");
  const auto followed = std::count_if(scenes.begin(), scenes.end(),
                                      [](const Scene& s) { return s.objects.size() == 1; });
  RecordProperty("followed", static_cast<int>(followed));
  EXPECT_GE(followed, 1150);
}

}  // namespace
}  // namespace perception
