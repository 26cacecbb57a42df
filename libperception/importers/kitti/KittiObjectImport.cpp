#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/SensorLabels.h"
#include "libperception/importers/StampText.h"
#include "libperception/importers/kitti/KittiLabels.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

constexpr const char* kBoxesLabel = "LABELLED_BOXES";
/// A folder of the benchmark and what its files end in.
struct KittiPart {
  const char* folder;
  std::vector<std::string> endings;
};
const KittiPart kKittiImages{"image_2", {".png", ".jpg", ".jpeg"}};
const KittiPart kKittiScans{"velodyne", {".bin", ".bin.gz"}};
const KittiPart kKittiLabels{"label_2", {".txt"}};
const KittiPart kCalibrations{"calib", {".txt"}};

/// Single frames in the layout of KITTI's object benchmark: image_2, calib, label_2, velodyne.
class KittiObjectImporter final : public Importer {
 public:
  /// The files of `frames` are the frames; of `other` there may be none.
  KittiObjectImporter(const KittiPart& frames, const KittiPart& other)
      : frames_(frames), other_(other) {}
  void declare(CLI::App& cli) override {
    cli.add_option("--dir", dir_,
                   fmt::format("folder with {}/ and calib/, and where there are label_2/ and {}/",
                               frames_.folder, other_.folder))
        ->required();
    cli.add_flag("--label-boxes", label_boxes_,
                 "the labels' image boxes as detections LABELLED_BOXES: a detector without fault");
  }
  void prepare(ImportOptions& options) override {
    alone_ = options.rate <= 0;
    if (alone_) options.rate = kAloneRate;
    if (kRepeatRate < 2 * options.rate * options.repeat)
      failUsage(
          "--repeat is too large for --rate: frames follow each other at --rate, each shown at 200 "
          "Hz");
  }
  void run(ImportLog& log) override;

 private:
  struct Frame {
    FrameFile file;
    std::string image;  ///< empty: none
    Pose3 T_world_ego = Pose3::Identity();
    KittiCalibration calibration;
    std::optional<LidarCloud> cloud;
    std::vector<KittiLabel> labels;
  };
  Frame read(const FrameFile& file, ImportLog& log) const;
  void write(const Frame& frame, Stamp stamp, bool last, ImportLog& log) const;
  std::string path(const KittiPart& part) const { return (fs::path(dir_) / part.folder).string(); }
  std::string fileOf(const KittiPart& part, const char* what, const FrameFile& frame,
                     ImportLog& log) const;

  const KittiPart &frames_, &other_;
  std::string dir_;
  bool label_boxes_ = false;
  bool alone_ = true;  ///< frames of different places; else a sequence of a standing vehicle
};

/// The frame's file of `part`; empty: there is no such folder, or no such file in it (a warning).
std::string KittiObjectImporter::fileOf(const KittiPart& part, const char* what,
                                        const FrameFile& frame, ImportLog& log) const {
  if (!fs::exists(path(part))) return {};
  std::string file = fileOfStem(path(part), frame.stem, part.endings);
  if (file.empty()) log.missing(what, path(part), frame.number);
  return file;
}

KittiObjectImporter::Frame KittiObjectImporter::read(const FrameFile& file, ImportLog& log) const {
  Frame frame;
  frame.file = file;
  const std::string calibration = fileOfStem(path(kCalibrations), file.stem, kCalibrations.endings);
  if (calibration.empty()) {
    throw DataError(
        fmt::format("{}/{}.txt: no calibration for {}", path(kCalibrations), file.stem, file.path),
        ExitCode::kNoInput);
  }
  frame.calibration = readKittiCalibration(calibration);
  if (const std::string labels = fileOf(kKittiLabels, "labels", file, log); !labels.empty()) {
    frame.labels = readKittiObjectLabels(labels, file.number);
    for (KittiLabel& label : frame.labels) label.id += 1000 * file.number;  // unique over frames
  }
  if (const std::string scan = fileOf(kKittiScans, "scan", file, log); !scan.empty())
    frame.cloud = readKittiScan(scan);
  frame.image = fileOf(kKittiImages, "image", file, log);
  return frame;
}

void KittiObjectImporter::write(const Frame& frame, Stamp stamp, bool last, ImportLog& log) const {
  const KittiCalibration& calibration = frame.calibration;
  const Pose3 T_ego_velo = levelVelodyne(calibration);
  const Pose3 T_ego_camera =
      T_ego_velo * calibration.T_cam0_velo.inverse() * calibration.T_cam0_cam2;
  log.ego(stamp, frame.T_world_ego);
  if (last) log.frame(stamp, frame.file.number);
  if (frame.cloud) log.sensor(kLidarTop, stamp, T_ego_velo, *frame.cloud);
  if (label_boxes_) {
    ObjectDetections found;
    found.camera = calibration.camera;
    for (const KittiLabel& label : frame.labels) {
      if (label.type == "DontCare") continue;
      ObjectDetection& object = found.objects.emplace_back();
      object.label = label.type;
      object.score = 1;
      object.image_box = label.image_box;
      object.heading = wrapAngle(label.alpha);
    }
    log.sensor(kBoxesLabel, stamp, T_ego_camera, std::move(found));
  }
  if (!last) return;  // frame number, image and truth are at the last repetition
  if (!frame.image.empty())
    log.image({kCameraLeft, frame.image, stamp, calibration.camera, T_ego_camera},
              frame.file.number);
  for (const KittiLabel& label : frame.labels)
    log.truth(stamp, truthOf(label, calibration, frame.T_world_ego * T_ego_velo, frame.cloud));
}

void KittiObjectImporter::run(ImportLog& log) {
  const auto files = frameFiles(path(frames_), frames_.endings);
  if (fs::exists(path(kKittiLabels))) log.expectTruth();
  std::int64_t place = 0;  // frame numbers of single frames are not times
  for (const FrameFile& file : files) {
    if (!log.wants(file.number)) continue;
    Frame frame = read(file, log);
    if (alone_) frame.T_world_ego = makePose(kAloneDistance * static_cast<double>(place), 0, 0, 0);
    const Stamp begin = stampAtRate(kUndatedStart, place++, log.options().rate);
    const int repeat = log.options().repeat;
    if (alone_) log.ego(begin + -kStillPoses, frame.T_world_ego);
    for (int k = 0; k < repeat; ++k)
      write(frame, stampAtRate(begin, k, kRepeatRate), k + 1 == repeat, log);
    if (alone_)
      log.ego(stampAtRate(begin, repeat - 1, kRepeatRate) + kStillPoses, frame.T_world_ego);
    log.progress(place, static_cast<std::int64_t>(files.size()));
  }
}

}  // namespace

std::unique_ptr<Importer> makeImagesImporter() {
  return std::make_unique<KittiObjectImporter>(kKittiImages, kKittiScans);
}
std::unique_ptr<Importer> makeKittiObjectImporter() {
  return std::make_unique<KittiObjectImporter>(kKittiScans, kKittiImages);
}

}  // namespace perception
