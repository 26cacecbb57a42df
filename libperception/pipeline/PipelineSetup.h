#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"
#include "libperception/grid/GridParams.h"
#include "libperception/grid/way/StopAdvice.h"
#include "libperception/lidar/ground/GroundPlane.h"
#include "libperception/measurement/frames/FrontEnd.h"
#include "libperception/measurement/models/DetectionModel.h"
#include "libperception/scene/SceneFromPosterior.h"
#include "libperception/sensors/ego/EgoPose.h"
#include "libperception/sensors/frames/ScanMerge.h"
#include "libperception/weather/PointFilter.h"

namespace perception {

/// Registry entry of a front end: [sensor.LABEL] kind.
struct FrontEndRow {
  std::string kind;
  std::unique_ptr<FrontEnd> (*make)(Config&, const std::string& label, const ClassTable&);
};

/// Registry of front ends: lidar, boxes, radar, positions. A program may append rows before it
/// reads its configuration, and register a new modality by addModality() (measurement/Modality.h).
std::vector<FrontEndRow>& frontEnds();

/// [run]: sensors, association and output of a run.
struct RunParams {
  unsigned long long seed = 1;                ///< of all random streams; assumed
  std::string sensors = "C+L+R";              ///< modalities in use: letters joined by +
  std::vector<std::string> without;           ///< labels of sensors excluded from those
  Proposal association = Proposal::kSampled;  ///< method.md 5.4, [radecki2016]
  /// Label of the sensor at whose scans scenes are made; empty: the first lidar in use, else the
  /// first sensor.
  std::string output_sensor;
  double output_rate = 0;       ///< [Hz] scenes at a fixed rate instead; 0: at scans
  double output_lag = 0;        ///< [s] by which scenes are late (method.md 5.17); 0: at once
  double reorder_window = 0.2;  ///< [s] largest delay of an observation (method.md 1.2)
  double sensor_timeout = 1;    ///< [s] without frames after which a sensor is lost; assumed
  double clock_jump =
      5;  ///< [s] smallest clock jump; backward: a new epoch, forward: an event; assumed
  bool write_measurements = false;  ///< write measurements.csv, scans.csv, sensors.csv

  static const std::vector<std::string>& associationNames();  ///< in the order of Proposal
  void visit(ParamVisitor& v);
};

/// Everything that a run reads from its INI.
struct PipelineSetup {
  /// One [sensor.LABEL].
  struct Sensor {
    std::string label;
    DetectionParams params;
    ScanParams scan;  ///< lidars
    std::shared_ptr<const FrontEnd> front_end;
    bool active = false;        ///< its modality is in use and it is not excluded by `without`
    bool gives_ground = false;  ///< the ground plane is estimated from its point clouds

    bool used() const { return active || gives_ground; }
    bool isLidarInUse() const { return params.kind == "lidar" && used(); }
    bool isRadarInUse() const { return params.kind == "radar" && active; }
  };
  RunParams run;
  FilterModel model;
  ParticleFilterParams particles;
  SceneParams scene;
  EgoPoseParams ego;
  GroundParams ground;
  WeatherParams weather;
  GridParams grid;              ///< safety grid
  StopParams stop;              ///< its advice
  std::vector<Sensor> sensors;  ///< in the order of the INI

  /// Reads all sections. Faults are collected in the configuration; Config::finish() throws them.
  static PipelineSetup read(Config& config);
  /// Reads an INI file with settings "section.key=value" that override it. Throws ConfigError.
  static PipelineSetup fromFile(const std::string& ini, const std::vector<std::string>& settings);
  /// Index of the sensor with this label, or into which the scanner of this label is merged.
  std::optional<std::size_t> sensorOf(const std::string& label) const;
};

}  // namespace perception
