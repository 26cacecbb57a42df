#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/detectors/DpmOptions.h"
#include "libperception/detectors/GroundGate.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// [model.NAME]: one model file of a detector and the calibration of its scores.
struct DetectorModelParams {
  std::string file;                ///< relative to [detector] folder
  std::string label;               ///< class name of its boxes; empty: the model's own
  std::vector<std::string> names;  ///< networks: INDEX=LABEL of the classes to report
  double threshold = -1e9;         ///< [score] weaker boxes are dropped; assumed: none
  double low = 0.5, high = 4;      ///< [m] heights of its objects on the ground (assumed)
  /// P(object | score) = 1 / (1 + exp(-slope (score - even_score))): written by --calibrate.
  double slope = 0;       ///< [1/score]; 0: not calibrated
  double even_score = 0;  ///< score at which P(object) is one half
  /// The same for single labels of a network.
  std::vector<std::pair<std::string, double>> label_slope, label_even_score;

  void visit(ParamVisitor& v);
  double slopeOf(const std::string& name) const;
  double evenScoreOf(const std::string& name) const;
};

/// [dpm]: parameters of the engine for deformable part models.
struct DpmParams {
  DpmOptions options;

  void visit(ParamVisitor& v);
};

/// [onnx]: properties of a network that cv::dnn does not provide.
struct OnnxParams {
  int input = 416;              ///< [px] side of the square input (YOLOX-Nano, [ge2021])
  int layout = 0;               ///< of the output, an index into layoutNames(); 0: by its shape
  double overlap = 0.45;        ///< intersection over union of boxes of one object (assumed)
  bool windows = true;          ///< long images also in square windows (counted: ini/detectors)
  double window_overlap = 0.5;  ///< overlap of neighboring windows, share of their side (assumed)

  static const std::vector<std::string>& layoutNames();
  void visit(ParamVisitor& v);
};

/// [hog]: OpenCV's detector of people.
struct HogParams {
  double enlarge = 1.5;  ///< scale of the image: the smallest people detected have 96 px (assumed)
  double overlap = 0.5;  ///< intersection over union of boxes of one object (assumed)

  void visit(ParamVisitor& v);
};

/// [detector]: back end and models.
struct DetectorSetup {
  int backend = 0;          ///< index into detectorBackends()
  std::string folder;       ///< of the models' files
  bool ground_gate = true;  ///< search only where the ground allows objects (method.md 8.8)
  double ground_slope_sigma = radians(1.2);  ///< [rad] of road and pitch (method.md 8.8)
  std::vector<std::pair<std::string, DetectorModelParams>> models;  ///< by name, as in the INI
  DpmParams dpm;
  OnnxParams onnx;
  HogParams hog;

  /// Reads [detector], [model.*] and the sections of the back ends.
  static DetectorSetup read(Config& config);
  void visit(ParamVisitor& v);
  std::string backendName() const;
  /// Where the model's file lies: in `folder`, else in the environment's PERCEPTION_MODELS.
  /// @throws DataError kNoInput where it is in neither
  std::string pathOf(const DetectorModelParams& model) const;
};

/// Detects objects in images of a pinhole camera. Scores are in the back end's own unit.
class Detector {
 public:
  virtual ~Detector() = default;
  /// Boxes [px], best first, one per object.
  virtual std::vector<ObjectDetection> detect(const Raster& image,
                                              const SearchRegion& region) const = 0;
  /// Whether detect() is thread-safe.
  virtual bool parallel() const { return false; }
};

/// A table of back ends; a new one needs a factory function and a row.
struct DetectorBackend {
  const char* name;
  std::unique_ptr<Detector> (*make)(const DetectorSetup& setup);  ///< null: not in this build
};
const std::vector<DetectorBackend>& detectorBackends();

/// Throws DataError for models that are missing or unusable, ConfigError for a back end that is not
/// in this build. Null for `file`, which uses the boxes in the log.
std::unique_ptr<Detector> makeDetector(const DetectorSetup& setup);

std::unique_ptr<Detector> makeDpmDetector(const DetectorSetup& setup);
std::unique_ptr<Detector> makeOnnxDetector(const DetectorSetup& setup);
std::unique_ptr<Detector> makeHogDetector(const DetectorSetup& setup);

/// Converts scores to log-odds of a right box (method.md 8.8) by the models' calibrations; boxes of
/// models without one keep their score. Returns how many do.
std::size_t calibrateScores(const DetectorSetup& setup, std::vector<ObjectDetection>& objects);

}  // namespace perception
