#include "libperception/grid/CSafetyGrid.h"

#include <gtest/gtest.h>
#include <mrpt/config/CConfigFileMemory.h>
#include <mrpt/io/CFileGZInputStream.h>
#include <mrpt/io/CMemoryStream.h>
#include <mrpt/maps/CMultiMetricMap.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservationPointCloud.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/serialization/CArchive.h>
#include <octomap/OcTree.h>

#include <filesystem>
#include <memory>

#include "libperception/core/Error.h"
#include "libperception/grid/CGridExport.h"
#include "tests/support/TemporaryFolder.h"

namespace perception {
namespace {

/// A wall 10 m ahead of a lidar 2 m above the vehicle's origin.
mrpt::obs::CObservationPointCloud wall(double t) {
  mrpt::obs::CObservationPointCloud observation;
  observation.timestamp = mrpt::Clock::fromDouble(1000 + t);
  observation.sensorPose = mrpt::poses::CPose3D(0, 0, 2, 0, 0, 0);
  auto points = mrpt::maps::CSimplePointsMap::Create();
  for (double y = -2; y <= 2; y += 0.05)
    for (double z = -1.5; z <= 0; z += 0.05)
      points->insertPoint(10.1F, static_cast<float>(y), static_cast<float>(z));
  observation.pointcloud = points;
  return observation;
}

class CSafetyGridOf : public testing::TestWithParam<GridParams::BackEnd> {
 protected:
  static GridParams params() {
    GridParams p;
    p.back_end = GetParam(), p.size = 40;
    return p;
  }
  static void fill(CSafetyGrid& map) {
    for (int i = 0; i < 4; ++i) map.insertObservation(wall(0.1 * i));
  }
};

TEST_P(CSafetyGridOf, TakesThePoseOfTheSensor) {
  registerSafetyGrid();
  CSafetyGrid map(params());
  EXPECT_TRUE(map.isEmpty());
  fill(map);
  EXPECT_FALSE(map.isEmpty());
  EXPECT_TRUE(map.grid().isOccupied({10.1, 0, 1.5}));
  EXPECT_NEAR(map.grid().freeDistance({}).distance, 10, 0.2 + 1e-6);
  map.clear();
  EXPECT_TRUE(map.isEmpty());
}

TEST_P(CSafetyGridOf, ComesBackFromAStreamWithWhatItKnew) {
  registerSafetyGrid();
  CSafetyGrid map(params());
  fill(map);
  mrpt::io::CMemoryStream stream;
  auto archive = mrpt::serialization::archiveFrom(stream);
  archive << map;
  stream.Seek(0);
  CSafetyGrid copy;
  archive >> copy;
  EXPECT_EQ(copy.grid().params().back_end, GetParam());
  EXPECT_EQ(copy.grid().occupiedCells().size(), map.grid().occupiedCells().size());
  EXPECT_NEAR(copy.grid().freeDistance({}).distance, map.grid().freeDistance({}).distance, 1e-9);
}

TEST_P(CSafetyGridOf, WritesFilesThatOctoMapAndMrptRead) {
  const test::TemporaryFolder folder;
  CSafetyGrid map(params());
  fill(map);
  const std::string prefix = (std::filesystem::path(folder.path()) / "grid").string();
  map.saveMetricMapRepresentationToFile(prefix);
  const bool flat = map.grid().occupiedCells().front().size.z() > 1;
  const double z = flat ? map.grid().occupiedCells().front().center.z() : 1.5;

  const std::unique_ptr<octomap::AbstractOcTree> read(
      octomap::AbstractOcTree::read(prefix + ".ot"));
  const auto* full = dynamic_cast<const octomap::OcTree*>(read.get());
  ASSERT_NE(full, nullptr);
  const auto* node = full->search(10.1, 0, z);
  ASSERT_NE(node, nullptr);
  EXPECT_NEAR(static_cast<double>(node->getLogOdds()), map.grid().logOdds({10.1, 0, z}), 0.01);
  octomap::OcTree binary(prefix + ".bt");
  const auto* occupied = binary.search(10.1, 0, z);
  ASSERT_NE(occupied, nullptr);
  EXPECT_TRUE(binary.isNodeOccupied(occupied));

  mrpt::io::CFileGZInputStream file(prefix + ".gridmap.gz");
  mrpt::maps::COccupancyGridMap2D ground;
  mrpt::serialization::archiveFrom(file) >> ground;
  EXPECT_LT(ground.getPos(10.1F, 0), 0.3F) << "MRPT: 0 is occupied";
  EXPECT_GT(ground.getPos(5, 0), 0.5F);
  EXPECT_GT(std::filesystem::file_size(prefix + ".png"), 100U);
}

TEST_P(CSafetyGridOf, IsDrawn) {
  CSafetyGrid map(params());
  fill(map);
  mrpt::opengl::CSetOfObjects scene;
  map.getVisualizationInto(scene);
  EXPECT_EQ(scene.size(), 1U);
}

TEST(GridExport, AFullDiskIsAnErrorAndAFileIsWholeOrAbsent) {
  const auto grid = makeSafetyGrid(GridParams());
  const test::TemporaryFolder folder;
  for (const char* name : {"full.bt", "full.gridmap.gz"}) {
    const std::string full = folder / name;
    std::filesystem::create_symlink("/dev/full", full);
    try {
      saveGrid(*grid, full);
      FAIL() << "a full disk was not noticed";
    } catch (const OutputError& error) {
      EXPECT_EQ(error.code(), ExitCode::kIoError);
    }
    std::filesystem::remove(full);
    EXPECT_THROW(saveGrid(*grid, std::string("/no/such/folder/") + name), OutputError);
  }
  saveGrid(*grid, folder / "grid.png");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

INSTANTIATE_TEST_SUITE_P(BackEnds, CSafetyGridOf,
                         testing::Values(GridParams::BackEnd::kOctomap,
                                         GridParams::BackEnd::kMrpt2d,
                                         GridParams::BackEnd::kRolling,
                                         GridParams::BackEnd::kRolling2d));

TEST(CSafetyGrid, StandsInAListOfMetricMaps) {
  registerSafetyGrid();
  mrpt::config::CConfigFileMemory config(
      "[maps]\nperception::CSafetyGrid_count = 1\n[maps_CSafetyGrid_00_creationOpts]\n"
      "[maps_perception::CSafetyGrid_00_creationOpts]\nback_end = rolling\nsize = 30\n");
  mrpt::maps::TSetOfMetricMapInitializers list;
  list.loadFromConfigFile(config, "maps");
  mrpt::maps::CMultiMetricMap maps;
  maps.setListOfMaps(list);
  ASSERT_EQ(maps.maps.size(), 1U);
  auto map = maps.mapByClass<CSafetyGrid>();
  ASSERT_TRUE(map);
  EXPECT_EQ(map->grid().params().back_end, GridParams::BackEnd::kRolling);
  for (int i = 0; i < 4; ++i) maps.insertObservation(wall(0.1 * i));
  EXPECT_TRUE(map->grid().isOccupied({10.1, 0, 1.5}));
}

}  // namespace
}  // namespace perception
