#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/detectors/DpmOptions.h"
#include "libperception/detectors/GroundGate.h"
#include "libperception/detectors/HeadingHead.h"
#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// [model.NAME]: one file of a detector, and what its scores mean.
struct DetectorModelParams {
  std::string file;                ///< relative to [detector] folder
  std::string label;               ///< class name of its boxes; empty: the model's own
  std::vector<std::string> names;  ///< networks: INDEX=LABEL of the classes that are wanted
  double threshold = -1e9;         ///< [score] weaker boxes are dropped: none (assumed)
  double low = 0.5, high = 4;      ///< [m] heights of its objects on the ground (assumed)
  /// P(object | score) = 1 / (1 + exp(-slope (score - even_score))): written by --calibrate.
  double slope = 0;       ///< [1/score]; 0: not calibrated
  double even_score = 0;  ///< score of a box that is as likely right as wrong
  /// The same for single labels of a network.
  std::vector<std::pair<std::string, double>> label_slope, label_even_score;

  void visit(ParamVisitor& v);
  double slopeOf(const std::string& name) const;
  double evenScoreOf(const std::string& name) const;
};

/// [dpm]: how densely the engine of part models searches.
struct DpmParams {
  DpmOptions options;

  void visit(ParamVisitor& v);
};

/// [onnx]: what cv::dnn does not tell of a network.
struct OnnxParams {
  int input = 416;              ///< [px] side of the square input (YOLOX-Nano, [ge2021])
  int layout = 0;               ///< of the output, a place in layoutNames(); 0: by its shape
  double overlap = 0.45;        ///< intersection over union of boxes that are one object (assumed)
  bool windows = true;          ///< long images also in squares (measured on KITTI: ini/detectors)
  double window_overlap = 0.5;  ///< share of a square that the next one sees, too (assumed)

  static const std::vector<std::string>& layoutNames();
  void visit(ParamVisitor& v);
};

/// [hog]: OpenCV's detector of people.
struct HogParams {
  double enlarge = 1.5;  ///< of the image: it knows people of 96 px and more (assumed)
  double overlap = 0.5;  ///< intersection over union of boxes of one object (assumed)

  void visit(ParamVisitor& v);
};

/// [detector]: which back end, with which models.
struct DetectorSetup {
  int backend = 0;          ///< a place in detectorBackends()
  std::string folder;       ///< of the models' files
  bool ground_gate = true;  ///< search only where objects can stand (method.md 8.8)
  double ground_slope_sigma = radians(1.2);  ///< [rad] of road and pitch (method.md 8.8)
  std::vector<std::pair<std::string, DetectorModelParams>> models;  ///< by name, as in the INI
  std::vector<HeadingHeadParams> headings;                          ///< [heading.NAME]
  DpmParams dpm;
  OnnxParams onnx;
  HogParams hog;

  /// Reads [detector], [model.*], [heading.*] and the sections of the back ends.
  static DetectorSetup read(Config& config);
  void visit(ParamVisitor& v);
  std::string backendName() const;
  std::string pathOf(const DetectorModelParams& model) const;
};

/// Finds objects in pictures of a pinhole camera. Scores are the back end's own.
class Detector {
 public:
  virtual ~Detector() = default;
  /// Boxes in pixels, best first, each object once.
  virtual std::vector<ObjectDetection> detect(const Raster& image,
                                              const SearchRegion& region) const = 0;
  /// May detect() be called from several threads at once?
  virtual bool parallel() const { return false; }
};

/// A row per back end: to add one, write its maker and its row.
struct DetectorBackend {
  const char* name;
  std::unique_ptr<Detector> (*make)(const DetectorSetup& setup);  ///< null: not in this build
};
const std::vector<DetectorBackend>& detectorBackends();

/// Throws DataError for models that are missing or cannot be used, ConfigError for a back end that
/// is not in this build. Empty for `file`, which takes
/// the boxes that a log already holds.
std::unique_ptr<Detector> makeDetector(const DetectorSetup& setup);

std::unique_ptr<Detector> makeDpmDetector(const DetectorSetup& setup);
std::unique_ptr<Detector> makeCvDpmDetector(const DetectorSetup& setup);
std::unique_ptr<Detector> makeOnnxDetector(const DetectorSetup& setup);
std::unique_ptr<Detector> makeHogDetector(const DetectorSetup& setup);

/// Scores become log-odds of a right box (method.md 5.2: evidence for existence), by the models'
/// calibrations; boxes of models without one keep their score. Returns how many kept it.
std::size_t calibrateScores(const DetectorSetup& setup, std::vector<ObjectDetection>& objects);

}  // namespace perception
