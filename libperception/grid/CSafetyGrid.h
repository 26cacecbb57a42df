#pragma once
#include <mrpt/maps/CMetricMap.h>
#include <mrpt/obs/obs_frwds.h>

#include <memory>
#include <string>

#include "libperception/grid/SafetyGrid.h"

namespace perception {

/// A safety grid as an MRPT metric map: inserts any observation that a points map accepts, can be a
/// member of a CMultiMetricMap by INI ("perception::CSafetyGrid"), is serialized with its cells,
/// and is displayed by MRPT's tools. Returns within the slab are obstacles, others only clear; with
/// ground and trust known, insert a GridScan into grid() instead.
class CSafetyGrid : public mrpt::maps::CMetricMap {
  DEFINE_SERIALIZABLE(CSafetyGrid, perception)
 public:
  explicit CSafetyGrid(const GridParams& params = {});

  SafetyGrid& grid() { return *grid_; }
  const SafetyGrid& grid() const { return *grid_; }

  bool isEmpty() const override;
  std::string asString() const override;
  /// PREFIX.ot, .bt, .gridmap.gz and .png.
  void saveMetricMapRepresentationToFile(const std::string& prefix) const override;
  void getVisualizationInto(mrpt::opengl::CSetOfObjects& scene) const override;
  /// Not for localization: cells decay within seconds.
  double internal_computeObservationLikelihood(const mrpt::obs::CObservation&,
                                               const mrpt::poses::CPose3D&) const override {
    return 0;
  }
  bool internal_canComputeObservationLikelihood(const mrpt::obs::CObservation&) const override {
    return false;
  }

  MAP_DEFINITION_START(CSafetyGrid)
  GridParams params;
  MAP_DEFINITION_END(CSafetyGrid)

 protected:
  void internal_clear() override;
  bool internal_insertObservation(
      const mrpt::obs::CObservation& observation,
      const std::optional<const mrpt::poses::CPose3D>& robot_pose) override;

 private:
  std::shared_ptr<SafetyGrid> grid_;
  Pose3 T_world_ground_ = Pose3::Identity();  ///< of the last scan
  double stamp_ = 0;                          ///< [s] of the last scan
};

/// Registers the class with MRPT's serialization and map factory; call once at start-up.
void registerSafetyGrid();

}  // namespace perception
