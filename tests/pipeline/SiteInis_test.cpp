#include <gtest/gtest.h>

#include <algorithm>

#include "libperception/core/Error.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/lidar/LidarFrontEnd.h"
#include "libperception/pipeline/Pipeline.h"

namespace perception {
namespace {

TEST(SiteInis, AllLoadWithoutAFault) {
  for (const char* name : {"demo.ini",
                           "kitti.ini",
                           "kitti_object.ini",
                           "vod.ini",
                           "wads.ini",
                           "radiate.ini",
                           "comma2k19.ini",
                           "udacity.ini",
                           "gps_object.ini",
                           "skynet.ini",
                           "skynet_duc.ini",
                           "skynet_paper.ini",
                           "skynet_crowds.ini",
                           "skynet_shapes.ini",
                           "skynet_lanes.ini",
                           "gnss_gap.ini",
                           "any-detector.ini",
                           "kitti-detections.ini",
                           "kitti-detections-unlabelled.ini",
                           "av2.ini",
                           "nuscenes.ini",
                           "cadc.ini",
                           "boreas.ini",
                           "semanticspray.ini",
                           "aimotive.ini"}) {
    Config config = Config::fromFile(std::string(PERCEPTION_SOURCE_DIR) + "/ini/" + name);
    PipelineSetup::read(config);
    EXPECT_NO_THROW(config.finish()) << name;
  }
}

TEST(SiteInis, ThePapersVehicleHasEightRadarsAndAPanorama) {
  Config config = Config::fromFile(std::string(PERCEPTION_SOURCE_DIR) + "/ini/skynet.ini");
  const PipelineSetup setup = PipelineSetup::read(config);
  const auto count = [&](Modality m) {
    return std::count_if(setup.sensors.begin(), setup.sensors.end(),
                         [&](const auto& s) { return s.active && s.params.modality == m; });
  };
  EXPECT_EQ(count(Modality::kRadar), 8);
  EXPECT_GE(count(Modality::kCamera), 1);
  EXPECT_GE(count(Modality::kLidar), 1);
}

TEST(SiteInis, ThePapersSetUpClustersTheBumpersLidarsAboveTheRoofLidarsGround) {
  Config config = Config::fromFile(std::string(PERCEPTION_SOURCE_DIR) + "/ini/skynet_paper.ini");
  const PipelineSetup setup = PipelineSetup::read(config);
  EXPECT_EQ(setup.particles.sample_size, 8);
  EXPECT_EQ(setup.model.proposal, Proposal::kSampled);
  EXPECT_GT(setup.model.params.decide_class, 0);
  const auto lidar = [&](const char* label) { return setup.sensors[*setup.sensorOf(label)]; };
  EXPECT_FALSE(lidar("LIDAR_TOP").active);
  EXPECT_TRUE(lidar("LIDAR_TOP").gives_ground);
  EXPECT_TRUE(lidar("IBEO").active);
  EXPECT_FALSE(lidar("IBEO").gives_ground);
  EXPECT_EQ(lidar("IBEO").params.precision.size(), 2U);
  EXPECT_EQ(setup.sensors[*setup.sensorOf("IBEO")].front_end->labelNames().size(), 2U);
}

TEST(SiteInis, AHeadingAsOneWideGaussianIsASensorSet) {
  const auto setupOf = [](const std::string& sensors) {
    Config config = Config::fromFile(std::string(PERCEPTION_SOURCE_DIR) + "/ini/skynet.ini");
    config.set("run.sensors=" + sensors);
    const PipelineSetup setup = PipelineSetup::read(config);
    config.finish();
    return setup;
  };
  EXPECT_EQ(setupOf("C+R").model.params.heading, HeadingMode::kSplit);
  const PipelineSetup wide = setupOf("C/H+R");
  EXPECT_EQ(wide.model.params.heading, HeadingMode::kWide);
  for (const auto& s : wide.sensors)
    EXPECT_EQ(s.active, s.params.modality != Modality::kLidar) << s.label;
  for (const char* wrong : {"C/R", "H+R", "C+", "", "C/H/R"})
    EXPECT_THROW(setupOf(wrong), ConfigError) << wrong;
}

TEST(SiteInis, PlacesMustBeKnownToHalfTheSizeOnlyWhereALidarTakesPart) {
  const auto placeWithin = [](const std::string& sensors) {
    Config config =
        Config::fromFile(std::string(PERCEPTION_SOURCE_DIR) + "/ini/kitti-detections.ini");
    config.set("run.sensors=" + sensors);
    return PipelineSetup::read(config).scene.place_within;
  };
  EXPECT_EQ(placeWithin("L"), 0.5);
  EXPECT_EQ(placeWithin("C+L"), 0.5);
  EXPECT_EQ(placeWithin("C"), 0);
}

TEST(SiteInis, LidarReturnsAreUsedAsFarAsTheVehicleNeedsThemToStop) {
  Config config = Config::fromFile(std::string(PERCEPTION_SOURCE_DIR) + "/ini/kitti.ini");
  const PipelineSetup setup = PipelineSetup::read(config);
  const auto lidar = std::find_if(setup.sensors.begin(), setup.sensors.end(),
                                  [](const auto& s) { return s.label == "LIDAR_TOP"; });
  ASSERT_NE(lidar, setup.sensors.end());
  const auto& front_end = dynamic_cast<const LidarFrontEnd&>(*lidar->front_end);
  const auto range = [&](double speed) {
    SensorFrame frame;
    frame.ego.velocity = {0, speed};
    return front_end.pointsFor(frame).range_max;
  };
  EXPECT_EQ(range(20), 80);
  const double end =
      std::max(front_end.params().points.vehicle_front, front_end.params().points.vehicle_rear);
  EXPECT_NEAR(range(30), stoppingDistance(30, 0, setup.stop) + setup.stop.margin + end, 1e-9);
  EXPECT_GT(range(30), 100);
}

}  // namespace
}  // namespace perception
