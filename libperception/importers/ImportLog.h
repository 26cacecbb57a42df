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
#include "libperception/importers/ScanOddities.h"
#include "libperception/importers/bags/DoubledMessages.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/sensors/rawlog/RawlogWriter.h"

namespace perception {

/// [Hz] of frames without stamps: the rate of most lidars.
inline constexpr double kUsualRate = 10;
/// [Hz] rate of repeated frames: high enough that no object would move noticeably.
inline constexpr double kRepeatRate = 200;
/// Isolated frames are separated in time [Hz] and position [m], so that tracks of one cannot
/// continue in the next.
inline constexpr double kAloneRate = 0.1, kAloneDistance = 500;
/// [s] Equal poses are written from this long before to this long after a static scene, so that the
/// ego velocity, a difference of poses, is zero.
inline constexpr double kStillPoses = 0.15;

/// Options of all importers.
struct ImportOptions {
  /// Where a log's images are.
  enum class Images {
    kReference,  ///< original files, referenced through FILE_Images/LABEL, a symbolic link
    kCopy,       ///< copied to FILE_Images beside the log, MRPT's convention
    kEmbed       ///< in the log, as JPEG
  };
  std::string output;                 ///< FILE.rawlog
  double rate = 0;                    ///< [Hz] of frames without stamps; 0: kUsualRate
  std::int64_t first = 0, last = -1;  ///< frame numbers; last -1: to the end
  int repeat = 1;                     ///< number of repetitions of isolated frames
  Images images = Images::kReference;

  bool wants(std::int64_t frame) const { return frame >= first && (last < 0 || frame <= last); }
};

/// Statistics of an import.
struct ImportResult {
  std::int64_t frames = 0, scans = 0, images = 0, radar_scans = 0, poses = 0;
  std::uint64_t points = 0, radar_returns = 0;
  std::map<std::string, std::uint64_t> detections;   ///< by detector
  std::map<std::string, std::uint64_t> others;       ///< other observations, by label
  std::uint64_t truth_rows = 0;                      ///< including ignored ones
  std::map<std::string, std::uint64_t> truth_types;  ///< rows by type
  std::string truth_file;                            ///< empty without truth
  std::uint64_t entries = 0, bytes = 0, bytes_inflated = 0;
  std::vector<std::string> notes;     ///< remarks for users of the log
  std::vector<std::string> warnings;  ///< missing data
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
  std::vector<double> distortion = {};  ///< k1 k2 p1 p2 k3; empty: rectified
};

/// Output of an importer: log, truth and statistics. The log has its final name only after close().
class ImportLog {
 public:
  explicit ImportLog(ImportOptions options, ImportProgress progress = {});

  const ImportOptions& options() const { return options_; }

  /// Whether the options want this frame of the recording; remembers which ones there are.
  bool wants(std::int64_t frame);

  /// Entries are in the order of calls. Uncertainty of 0: unknown, the minimum of the site INI
  /// applies.
  void ego(Stamp stamp, const Pose3& T_world_ego, const PoseUncertainty& uncertainty = {0, 0, 0});
  void frame(Stamp stamp, std::int64_t number);
  /// Doubled messages are left out and counted. Scans are mended (ScanOddities).
  void sensor(const SensorFrame& frame);
  /// The same of a frame that has no more than this. `T_ego_sensor` is the sensor's mounting.
  void sensor(const std::string& label, Stamp stamp, const Pose3& T_ego_sensor,
              decltype(SensorFrame::data) data);
  /// The same in two steps, for recordings of messages: a scan that comes again `within` a time [s]
  /// is a double, too.
  bool isResent(const SensorFrame& frame, double within) {
    return doubles_.isDouble(frame, within);
  }
  void uniqueSensor(const SensorFrame& frame);
  void image(const ImportedImage& image, std::int64_t frame);
  /// Any other observation: GNSS, IMU, odometry.
  void observation(const mrpt::obs::CObservation& observation);

  /// For sensors of different rates: writeInOrder() calls `write` in order of stamps, equal stamps
  /// in order of calls.
  void at(Stamp stamp, std::function<void()> write);
  void writeInOrder();

  /// Declares that there is truth, also if it has no rows.
  void expectTruth() { has_truth_ = true; }
  /// `t` of the row is set from `stamp`.
  void truth(Stamp stamp, TruthObject object);
  /// Reports a frame whose `what` (scan, image) is missing in `dir`.
  void missing(const std::string& what, const std::string& dir, std::int64_t frame);
  void note(const std::string& text) { result_.notes.push_back(text); }
  void warn(const std::string& text) { result_.warnings.push_back(text); }
  void progress(std::int64_t done, std::int64_t total) const;

  /// Writes the truth and closes the log. Throws DataError (kNoInput) if every frame misses data or
  /// no frame of the recording was wanted; if most scans of a lidar lie elsewhere (ScanOddities);
  /// OutputError.
  ImportResult close();

 private:
  void write(const mrpt::obs::CObservation& observation);
  void writeSensor(const SensorFrame& frame);
  std::string storedImage(const ImportedImage& image, std::int64_t frame);
  void setTruthVelocities();
  void warnOfMissing();
  void failWithoutFrames() const;

  ImportOptions options_;
  ImportProgress progress_;
  RawlogWriter log_;
  ImportResult result_;
  bool has_truth_ = false;
  bool any_wanted_ = false;
  DoubledMessages doubles_;
  ScanOddities oddities_;
  std::optional<std::pair<std::int64_t, std::int64_t>>
      numbers_;  ///< least, greatest frame there is
  std::optional<Stamp> first_stamp_;
  std::vector<std::pair<Stamp, TruthObject>> truth_;
  std::vector<std::pair<Stamp, std::function<void()>>> queue_;
  std::vector<std::pair<std::pair<std::string, std::string>, std::vector<std::int64_t>>> missing_;
  std::map<std::string, std::string> linked_;  ///< folder of each camera's images
};

/// FILE_Images, MRPT's folder for externally stored images.
std::string imageFolderOf(const std::string& rawlog);

/// Whether a class of ini/classes.ini covers this truth type. Importers set `ignore` for truth of
/// other types.
bool coveredType(const std::string& type);

/// Number of returns inside a box, both in the sensor frame.
int returnsInside(const ObjectDetection::SpaceBox& box, const LidarCloud& cloud);
/// Sets pose and size of a truth row from a box in a sensor's frame.
void placeTruth(const ObjectDetection::SpaceBox& box, const Pose3& T_world_sensor, TruthObject& o);

}  // namespace perception
