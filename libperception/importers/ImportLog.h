#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libperception/core/GroundTruth.h"
#include "libperception/measurement/SensorFrame.h"
#include "libperception/sensors/RawlogWriter.h"

namespace perception {

/// [Hz] of a frame that is shown repeatedly: so fast that nothing would have moved meanwhile, not
/// even what drives.
inline constexpr double kRepeatRate = 200;
/// Frames that stand alone are so far apart in time [Hz] and place [m] that no object of one is one
/// of the next.
inline constexpr double kAloneRate = 0.1, kAloneDistance = 500;
/// [s] Poses so long before and after a still world keep its vehicle from moving: velocities are
/// differences of poses.
inline constexpr double kStillPoses = 0.15;

/// What every importer understands.
struct ImportOptions {
  /// Where a log's images are.
  enum class Images {
    kReference,  ///< where they were; the log names them through FILE_Images/LABEL, a link
    kCopy,       ///< in FILE_Images beside the log, as MRPT's programs expect
    kEmbed       ///< inside the log, as JPEG
  };
  std::string output;                 ///< FILE.rawlog
  double rate = 0;                    ///< [Hz] of frames without stamps; 0: the format's own
  std::int64_t first = 0, last = -1;  ///< frame numbers; last -1: to the end
  int repeat = 1;                     ///< how often a frame that stands alone is shown
  Images images = Images::kReference;

  bool wants(std::int64_t frame) const { return frame >= first && (last < 0 || frame <= last); }
};

/// What an import wrote.
struct ImportResult {
  std::int64_t frames = 0, scans = 0, images = 0, radar_scans = 0, poses = 0;
  std::uint64_t points = 0, radar_returns = 0;
  std::map<std::string, std::uint64_t> detections;   ///< by detector
  std::map<std::string, std::uint64_t> others;       ///< entries of other kinds, by label
  std::uint64_t truth_rows = 0;                      ///< ignored ones included
  std::map<std::string, std::uint64_t> truth_types;  ///< rows by type
  std::string truth_file;                            ///< empty without truth
  std::uint64_t entries = 0, bytes = 0, bytes_inflated = 0;
  std::vector<std::string> notes;     ///< what a reader of the log should know
  std::vector<std::string> warnings;  ///< parts of the data that are missing
};

/// `progress(done, total)`, per frame.
using ImportProgress = std::function<void(std::int64_t, std::int64_t)>;

/// An image file of a recording.
struct ImportedImage {
  std::string label;  ///< of the camera
  std::string path;
  Stamp stamp;
  CameraModel camera;  ///< width and height are taken from the file
  Pose3 T_ego_camera = Pose3::Identity();
  std::vector<double> distortion;  ///< k1 k2 p1 p2 k3; empty: rectified
};

/// The log, truth and report that an importer writes; one for all formats. The log stands under its
/// name only after close().
class ImportLog {
 public:
  explicit ImportLog(ImportOptions options, ImportProgress progress = {});

  const ImportOptions& options() const { return options_; }

  /// Entries in the order of the calls. Deviations of 0: not known, the site's minimum holds.
  void ego(Stamp stamp, const Pose3& T_world_ego, const PoseUncertainty& uncertainty = {0, 0, 0});
  void frame(Stamp stamp, std::int64_t number);
  void sensor(const SensorFrame& frame);
  void image(const ImportedImage& image, std::int64_t frame);
  /// An entry of another kind: GNSS, IMU, odometry.
  void observation(const mrpt::obs::CObservation& observation);

  /// For sensors of several rates: `write` is called by writeInOrder(), in order of stamps and, of
  /// one stamp, of calls.
  void at(Stamp stamp, std::function<void()> write);
  void writeInOrder();

  /// There is truth, if only with no row.
  void expectTruth() { has_truth_ = true; }
  /// `t` of the row is set from `stamp`.
  void truth(Stamp stamp, TruthObject object);
  /// A frame whose `what` (scan, image) is not in `dir`.
  void missing(const std::string& what, const std::string& dir, std::int64_t frame);
  void note(const std::string& text) { result_.notes.push_back(text); }
  void warn(const std::string& text) { result_.warnings.push_back(text); }
  void progress(std::int64_t done, std::int64_t total) const;

  /// Writes the truth, closes the log, gives the report. Throws DataError (kNoInput) where every
  /// frame misses something, OutputError.
  ImportResult close();

 private:
  void write(const mrpt::obs::CObservation& observation);
  std::string storedImage(const ImportedImage& image, std::int64_t frame);
  void setTruthVelocities();
  void warnOfMissing();

  ImportOptions options_;
  ImportProgress progress_;
  RawlogWriter log_;
  ImportResult result_;
  bool has_truth_ = false;
  std::optional<Stamp> first_stamp_;
  std::vector<std::pair<Stamp, TruthObject>> truth_;
  std::vector<std::pair<Stamp, std::function<void()>>> queue_;
  std::vector<std::pair<std::pair<std::string, std::string>, std::vector<std::int64_t>>> missing_;
  std::map<std::string, std::string> linked_;  ///< folder of each camera's images
};

/// FILE.truth.csv beside FILE.rawlog.
std::string truthFileOf(const std::string& rawlog);
/// FILE_Images, where MRPT's programs look for what a log does not hold itself.
std::string imageFolderOf(const std::string& rawlog);

/// Types of the truth that a class of ours covers; an output of another type is neither right nor
/// wrong.
bool coveredType(const std::string& type);

/// Returns of a cloud inside a box, both in the sensor frame.
int returnsInside(const ObjectDetection::SpaceBox& box, const LidarCloud& cloud);
/// A truth row's place and size from a box in a sensor's frame.
void placeTruth(const ObjectDetection::SpaceBox& box, const Pose3& T_world_sensor, TruthObject& o);

}  // namespace perception
