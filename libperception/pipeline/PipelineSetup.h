#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/filter/CRbpfTracker.h"
#include "libperception/grid/GridParams.h"
#include "libperception/lidar/GroundPlane.h"
#include "libperception/measurement/DetectionModel.h"
#include "libperception/measurement/FrontEnd.h"
#include "libperception/scene/SceneFromPosterior.h"
#include "libperception/sensors/EgoPose.h"
#include "libperception/sensors/ScanMerge.h"
#include "libperception/weather/PointFilter.h"

namespace perception {

/// A kind of front end: [sensor.LABEL] kind.
struct FrontEndRow {
  std::string kind;
  std::unique_ptr<FrontEnd> (*make)(Config&, const std::string& label, const ClassTable&);
};

/// The table: lidar, boxes, radar, positions. A program may add rows before it reads its
/// configuration (and a row to modalities(), where the sensor is of none of them).
std::vector<FrontEndRow>& frontEnds();

/// [run]: what is run on a log, and when scenes are output.
struct RunParams {
  unsigned long long seed = 1;                ///< assumed: any number will do
  std::string sensors = "C+L+R";              ///< modalities in use: letters joined by +
  std::vector<std::string> without;           ///< labels of sensors that are left out all the same
  Proposal association = Proposal::kSampled;  ///< method.md 5.4, [radecki2016]
  /// Scenes at its scans; empty: the first lidar in use, else the first sensor.
  std::string output_sensor;
  double output_rate = 0;       ///< [Hz] instead: scenes at a fixed rate; 0: at scans
  double output_lag = 0;        ///< [s] scenes come so late, smoothed (method.md 5.17); 0: at once
  double reorder_window = 0.2;  ///< [s] how late an observation may come (method.md 1.2)
  double sensor_timeout = 1;    ///< [s] of silence after which a sensor is lost; assumed
  double clock_jump = 5;        ///< [s] back: a new epoch; forward: an event; assumed
  bool write_measurements = false;  ///< what the front ends found goes into the results, too

  static const std::vector<std::string>& associationNames();  ///< in the order of Proposal
  void visit(ParamVisitor& v);
};

/// All that a run reads from its INI.
struct PipelineSetup {
  /// One [sensor.LABEL].
  struct Sensor {
    std::string label;
    DetectionParams params;
    ScanParams scan;  ///< lidars
    std::shared_ptr<const FrontEnd> front_end;
    bool active = false;        ///< its measurements are used: its modality is in use
    bool gives_ground = false;  ///< its point clouds give the ground plane

    bool used() const { return active || gives_ground; }
  };
  RunParams run;
  FilterModel model;
  ParticleFilterParams particles;
  SceneParams scene;
  EgoPoseParams ego;
  GroundParams ground;
  WeatherParams weather;
  GridParams grid;              ///< of the safety grid in pictures
  std::vector<Sensor> sensors;  ///< in the order of the INI

  /// Reads every section; faults go to the configuration (throw them with Config::finish()).
  static PipelineSetup read(Config& config);
  /// The sensor whose own label, or that of a scanner merged into it, this is.
  std::optional<std::size_t> sensorOf(const std::string& label) const;
};

}  // namespace perception
