#include "libperception/grid/CSafetyGrid.h"

#include <fmt/format.h>
#include <mrpt/config/CConfigFileBase.h>
#include <mrpt/core/Clock.h>
#include <mrpt/maps/CSimplePointsMap.h>
#include <mrpt/obs/CObservation.h>
#include <mrpt/opengl/COctoMapVoxels.h>
#include <mrpt/opengl/CSetOfObjects.h>
#include <mrpt/poses/CPose3D.h>
#include <mrpt/rtti/CObject.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/MrptCompatibility.h"
#include "libperception/grid/CGridExport.h"

MAP_DEFINITION_REGISTER("perception::CSafetyGrid,safetyGrid", perception::CSafetyGrid)

namespace perception {

IMPLEMENTS_SERIALIZABLE(CSafetyGrid, CMetricMap, perception)

namespace {

const char* const kBackEndNames[] = {"octomap", "mrpt2d", "rolling", "rolling2d"};

Pose3 toPose(const mrpt::poses::CPose3D& pose) {
  Pose3 T = Pose3::Identity();
  T.matrix() = pose.getHomogeneousMatrixVal<mrpt::math::CMatrixDouble44>().asEigen();
  return T;
}

}  // namespace

CSafetyGrid::CSafetyGrid(const GridParams& params) : grid_(makeSafetyGrid(params)) {}

CSafetyGrid::TMapDefinition::TMapDefinition() = default;

// [PREFIX_creationOpts] back_end, resolution, size, tau, z_min, z_max; other parameters keep their
// defaults.
void CSafetyGrid::TMapDefinition::loadFromConfigFile_map_specific(
    const mrpt::config::CConfigFileBase& source, const std::string& prefix) {
  const std::string section = prefix + "_creationOpts";
  const std::string name =
      source.read_string(section, "back_end", kBackEndNames[static_cast<int>(params.back_end)]);
  const auto* row = std::find(std::begin(kBackEndNames), std::end(kBackEndNames), name);
  if (row == std::end(kBackEndNames))
    THROW_EXCEPTION_FMT("[%s] back_end: unknown '%s'", section.c_str(), name.c_str());
  params.back_end = static_cast<GridParams::BackEnd>(row - std::begin(kBackEndNames));
  params.resolution = source.read_double(section, "resolution", params.resolution);
  params.size = source.read_double(section, "size", params.size);
  params.tau = source.read_double(section, "tau", params.tau);
  params.z_min = source.read_double(section, "z_min", params.z_min);
  params.z_max = source.read_double(section, "z_max", params.z_max);
  if (!(params.resolution > 0) || !(params.size >= 10 * params.resolution) || !(params.tau > 0) ||
      !(params.z_min < params.z_max))
    THROW_EXCEPTION_FMT("[%s]: resolution, size, tau, z_min or z_max cannot be", section.c_str());
}

void CSafetyGrid::TMapDefinition::dumpToTextStream_map_specific(std::ostream& out) const {
  out << fmt::format(
      "back_end = {}\nresolution = {}\nsize = {}\ntau = {}\nz_min = {}\nz_max = {}\n",
      kBackEndNames[static_cast<int>(params.back_end)], params.resolution, params.size, params.tau,
      params.z_min, params.z_max);
}

using NewMap = decltype(resultOf(&CSafetyGrid::internal_CreateFromMapDefinition));
NewMap CSafetyGrid::internal_CreateFromMapDefinition(
    const mrpt::maps::TMetricMapInitializer& definition) {
  return NewMap(
      new CSafetyGrid(dynamic_cast<const CSafetyGrid::TMapDefinition&>(definition).params));
}

void CSafetyGrid::internal_clear() { grid_ = makeSafetyGrid(grid_->params()); }

bool CSafetyGrid::isEmpty() const { return grid_->knownCells().empty(); }

std::string CSafetyGrid::asString() const {
  return fmt::format("Safety grid ({}), {} cells occupied",
                     kBackEndNames[static_cast<int>(grid_->params().back_end)],
                     grid_->occupiedCells().size());
}

// Uses a points map, which handles the sensor pose of every class of observation.
bool CSafetyGrid::internal_insertObservation(
    const mrpt::obs::CObservation& observation,
    const std::optional<const mrpt::poses::CPose3D>& robot_pose) {
  mrpt::maps::CSimplePointsMap points;
  points.insertionOptions.minDistBetweenLaserPoints = 0;
  const mrpt::poses::CPose3D robot = robot_pose.value_or(mrpt::poses::CPose3D());
  if (!points.insertObservation(observation, robot)) return false;
  mrpt::poses::CPose3D sensor;
  observation.getSensorPose(sensor);

  GridScan scan;
  stamp_ = observation.timestamp == INVALID_TIMESTAMP
               ? stamp_
               : mrpt::Clock::toDouble(observation.timestamp);
  scan.stamp = Stamp::fromSeconds(stamp_);
  scan.T_world_ground = T_world_ground_ = toPose(robot);
  scan.origin = toPose(robot + sensor).translation();
  const Pose3 T_ground_world = scan.T_world_ground.inverse();
  const auto& x = points.getPointsBufferRef_x();
  const auto& y = points.getPointsBufferRef_y();
  const auto& z = points.getPointsBufferRef_z();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vector3 place(static_cast<double>(x[i]), static_cast<double>(y[i]),
                        static_cast<double>(z[i]));
    const double height = (T_ground_world * place).z();
    const bool hit = height >= grid_->params().z_min && height <= grid_->params().z_max;
    (hit ? scan.hits : scan.clear).push_back(place);
  }
  grid_->insert(scan);
  return true;
}

void CSafetyGrid::saveMetricMapRepresentationToFile(const std::string& prefix) const {
  for (const char* ending : {".ot", ".bt", ".gridmap.gz", ".png"})
    saveGrid(*grid_, prefix + ending);
}

void CSafetyGrid::getVisualizationInto(mrpt::opengl::CSetOfObjects& scene) const {
  const auto cells = grid_->occupiedCells();
  auto voxels = mrpt::opengl::COctoMapVoxels::Create();
  voxels->resizeVoxelSets(1);
  voxels->reserveVoxels(0, cells.size());
  mrpt::math::TPoint3D low(0, 0, 0), high(0, 0, 0);
  for (const GridCell& cell : cells) {
    const mrpt::math::TPoint3D p(cell.center.x(), cell.center.y(), cell.center.z());
    voxels->push_back_Voxel(0, {p, cell.size.x(), mrpt::img::TColor(220, 60, 40)});
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  voxels->setBoundingBox(low, high);
  scene.insert(voxels);
}

// Version 0 had other back ends.
uint8_t CSafetyGrid::serializeGetVersion() const { return 1; }

void CSafetyGrid::serializeTo(mrpt::serialization::CArchive& out) const {
  const GridParams& p = grid_->params();
  out << static_cast<uint8_t>(p.back_end) << p.resolution << p.size << p.hit << p.miss << p.low
      << p.high << p.tau << p.occupied << p.z_min << p.z_max << p.grade << p.ray_step << stamp_;
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) out << T_world_ground_.matrix()(row, column);
  const auto cells = grid_->knownCells();
  out << static_cast<uint64_t>(cells.size());
  for (const GridCell& cell : cells)
    out << cell.center.x() << cell.center.y() << cell.center.z() << cell.log_odds;
}

void CSafetyGrid::serializeFrom(mrpt::serialization::CArchive& in, uint8_t version) {
  if (version != 1) MRPT_THROW_UNKNOWN_SERIALIZATION_VERSION(version);
  GridParams p;
  uint8_t back_end = 0;
  in >> back_end >> p.resolution >> p.size >> p.hit >> p.miss >> p.low >> p.high >> p.tau >>
      p.occupied >> p.z_min >> p.z_max >> p.grade >> p.ray_step >> stamp_;
  const bool possible = back_end < std::size(kBackEndNames) && p.resolution >= 0.05 &&
                        p.size >= 10 * p.resolution && p.size <= 400 && p.z_min < p.z_max &&
                        p.ray_step > 1e-4;
  if (!possible) THROW_EXCEPTION("a safety grid of impossible size: the file is damaged");
  p.back_end = static_cast<GridParams::BackEnd>(back_end);
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 4; ++column) in >> T_world_ground_.matrix()(row, column);
  uint64_t count = 0;
  in >> count;
  std::vector<GridCell> cells;
  for (uint64_t i = 0; i < count; ++i) {
    GridCell cell;
    in >> cell.center.x() >> cell.center.y() >> cell.center.z() >> cell.log_odds;
    cells.push_back(cell);
  }
  grid_ = makeSafetyGrid(p);
  GridScan here;  // only sets the window
  here.stamp = Stamp::fromSeconds(stamp_);
  here.T_world_ground = T_world_ground_;
  here.origin = T_world_ground_.translation();
  grid_->insert(here);
  grid_->restore(cells);
}

void registerSafetyGrid() { mrpt::rtti::registerClass(CLASS_ID(CSafetyGrid)); }

}  // namespace perception
