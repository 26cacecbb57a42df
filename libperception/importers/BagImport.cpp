#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mrpt/obs/CObservationIMU.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/importers/BagContents.h"
#include "libperception/importers/ImportGps.h"
#include "libperception/importers/Importer.h"
#include "libperception/interop/RosScene.h"
#include "libperception/interop/RosSensors.h"
#include "libperception/sensors/Conversions.h"

namespace perception {
namespace {

/// [s] Messages are sorted by their stamps over this time of recording.
constexpr double kSorted = 1;
/// [s] Poses are written from this long before the first to this long after the last sensor data.
constexpr double kBagPoseMargin = 0.5;

bool isCloud(const std::string& type) { return type == "sensor_msgs/PointCloud2"; }
bool isRadar(const std::string& type) { return type == "radar_msgs/RadarScan"; }
bool isBoxes(const std::string& type) { return type == "vision_msgs/Detection3DArray"; }
bool isImage(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage";
}

/// "/camera/image_raw" as the label of a section: camera_image_raw.
std::string labelOf(const std::string& topic) {
  std::string label = topic.substr(
      topic.find_first_not_of('/') == std::string::npos ? 0 : topic.find_first_not_of('/'));
  std::replace(label.begin(), label.end(), '/', '_');
  return label;
}

/// The import of one recording.
class BagImport {
 public:
  BagImport(std::vector<std::string> files, Config& config, ImportLog& log)
      : files_(std::move(files)), config_(config), log_(log) {}
  void run();

 private:
  void readParams();
  void chooseBase();
  void choosePoses();
  std::vector<StampedPose> posesOfTree() const;
  std::vector<StampedPose> posesOfTopic(const std::string& topic) const;
  void chooseFrames();
  void readSensors();
  void take(const BagMessage& message);
  void takeSensor(const BagMessage& message, const BagTopicParams& params);
  std::shared_ptr<mrpt::obs::CObservation> imuObservation(const ros::Imu& imu,
                                                          const std::string& label);
  Pose3 mounting(const ros::Header& header, const BagTopicParams& params);
  std::optional<CameraModel> cameraBeside(const std::string& topic) const;
  void sorted(Stamp stamp, std::function<void()> write);
  void flush(std::optional<Stamp> until);
  void writePoses(Stamp until);

  std::vector<std::string> files_;
  Config& config_;
  ImportLog& log_;
  BagParams params_;
  std::map<std::string, BagTopicParams> topic_params_;
  BagContents contents_;
  std::string base_;
  Pose3 T_ego_base_ = Pose3::Identity();
  std::string frames_topic_;  ///< whose messages are the frames
  std::int64_t frame_ = -1;
  std::vector<StampedPose> poses_;  ///< of the ego frame
  std::size_t next_pose_ = 0;
  std::multimap<Stamp, std::function<void()>> queue_;
  std::optional<Stamp> last_;
  std::set<std::string> unplaced_;  ///< frames without a place on the vehicle
  std::map<std::string, std::pair<std::uint64_t, std::string>> bad_;
};

void BagImport::readParams() {
  params_ = config_.read<BagParams>("bag");
  for (const std::string& section : config_.sectionsWithPrefix("topic.")) {
    const std::string topic = section.substr(std::string("topic.").size());
    topic_params_[topic] = config_.read<BagTopicParams>(section);
    if (contents_.topics.count(topic) == 0)
      config_.fault(section, "",
                    fmt::format("the recording has no such topic; there are: {}", [this] {
                      std::vector<std::string> names;
                      for (const auto& row : contents_.topics) names.push_back(row.first);
                      return fmt::format("{}", fmt::join(names, " "));
                    }()));
  }
  const std::string& poses = params_.poses;
  if (!poses.empty() && poses != "tf" && poses != "none" && contents_.poses.count(poses) == 0)
    config_.fault("bag", "poses", poses + ": expected tf, none or a topic with poses");
  if (!params_.base_frame.empty() && !contents_.tree.has(params_.base_frame))
    config_.fault("bag", "base_frame", params_.base_frame + ": the recording has no such frame");
  config_.finish();
  if (!params_.base_pose.empty()) T_ego_base_ = poseOfNumbers(params_.base_pose);
}

void BagImport::chooseBase() {
  base_ = params_.base_frame;
  for (const char* usual : {"base_footprint", "base_link", "ego", "vehicle"}) {
    if (base_.empty() && contents_.tree.has(usual)) base_ = usual;
  }
  if (base_.empty() && !contents_.tree.moving().empty()) base_ = contents_.tree.moving().front();
  for (const auto& row : contents_.poses) {
    if (base_.empty()) base_ = row.second.frame;
  }
}

std::vector<StampedPose> BagImport::posesOfTree() const {
  std::vector<StampedPose> poses;
  const std::string world = contents_.tree.movesIn(base_);
  for (const Stamp stamp : contents_.tree.stampsOf(base_)) {
    if (const auto T = contents_.tree.at(world, base_, stamp))
      poses.push_back({stamp, *T * T_ego_base_.inverse()});
  }
  return poses;
}

std::vector<StampedPose> BagImport::posesOfTopic(const std::string& topic) const {
  const BagContents::Poses& given = contents_.poses.at(topic);
  std::vector<StampedPose> poses;
  for (const StampedPose& pose : given.poses) {
    const auto T_pose_base = given.frame.empty() || given.frame == base_
                                 ? std::optional<Pose3>(Pose3::Identity())
                                 : contents_.tree.at(given.frame, base_, pose.stamp);
    poses.push_back(
        {pose.stamp, pose.pose * T_pose_base.value_or(Pose3::Identity()) * T_ego_base_.inverse()});
  }
  return poses;
}

void BagImport::choosePoses() {
  std::string source = params_.poses;
  if (source.empty() && !contents_.tree.movesIn(base_).empty()) source = "tf";
  if (source.empty() && !contents_.poses.empty()) source = contents_.poses.begin()->first;
  if (source.empty() || source == "none") {
    log_.note("no poses are taken: they are found from GPS and inertial unit, or by odometry");
    return;
  }
  poses_ = source == "tf" ? posesOfTree() : posesOfTopic(source);
  if (source == "tf" && poses_.empty()) {
    std::string others;
    for (const auto& row : contents_.poses) others += " " + row.first;
    throw ConfigError(
        fmt::format("[bag] poses: tf: no transform of the recording moves \"{}\", "
                    "expected none{}{}",
                    base_, others.empty() ? "" : " or a topic with poses:", others));
  }
  log_.note(
      fmt::format("poses: {} of frame \"{}\" from {}", poses_.size(), base_,
                  source == "tf" ? "tf, in \"" + contents_.tree.movesIn(base_) + "\"" : source));
}

/// The frames are the scans of the first cloud topic, else of the first radar, else the images of
/// the first camera, else the boxes of the first detector.
void BagImport::chooseFrames() {
  for (const auto& wanted : {&isCloud, &isRadar, &isImage, &isBoxes}) {
    for (const auto& [name, row] : contents_.topics) {
      const auto params = topic_params_.find(name);
      const bool used =
          params == topic_params_.end() ? !isBoxes(row.topic.type) : params->second.use;
      if (frames_topic_.empty() && used && row.topic.unknown_encoding.empty() &&
          wanted(row.topic.type))
        frames_topic_ = name;
    }
  }
}

void BagImport::sorted(Stamp stamp, std::function<void()> write) {
  queue_.emplace(stamp, std::move(write));
}

/// Poses up to the stamp, but those long before the first data.
void BagImport::writePoses(Stamp until) {
  for (; next_pose_ < poses_.size() && poses_[next_pose_].stamp <= until; ++next_pose_) {
    const StampedPose& pose = poses_[next_pose_];
    if (last_ || until - pose.stamp < kBagPoseMargin) log_.ego(pose.stamp, pose.pose);
  }
}

/// Writes what is older than `until`; all without one.
void BagImport::flush(std::optional<Stamp> until) {
  while (!queue_.empty() && (!until || queue_.begin()->first < *until)) {
    const auto [stamp, write] = *queue_.begin();
    queue_.erase(queue_.begin());
    writePoses(stamp);
    last_ = stamp;
    write();
  }
}

std::optional<CameraModel> BagImport::cameraBeside(const std::string& topic) const {
  for (std::string folder = topic; folder.rfind('/') != std::string::npos;) {
    folder.erase(folder.rfind('/'));
    const auto info = contents_.cameras.find(folder + "/camera_info");
    if (info == contents_.cameras.end()) continue;
    return ros::cameraOf(info->second, topic.find("rect") != std::string::npos);
  }
  return {};
}

Pose3 BagImport::mounting(const ros::Header& header, const BagTopicParams& params) {
  if (!params.pose.empty()) return poseOfNumbers(params.pose);
  const std::string frame =
      header.frame_id.substr(!header.frame_id.empty() && header.frame_id[0] == '/' ? 1 : 0);
  if (frame == base_) return T_ego_base_;
  if (const auto T = contents_.tree.at(base_, frame, header.stamp)) return T_ego_base_ * *T;
  unplaced_.insert(frame);
  return T_ego_base_;
}

/// MRPT's class; absent parts (ROS: a covariance that begins with -1) stay absent.
std::shared_ptr<mrpt::obs::CObservation> BagImport::imuObservation(const ros::Imu& imu,
                                                                   const std::string& label) {
  using namespace mrpt::obs;
  auto out = std::make_shared<CObservationIMU>();
  out->timestamp = fromStamp(imu.header.stamp);
  out->sensorLabel = label;
  if (imu.rates_covariance[0] >= 0) {
    out->set(IMU_WX, imu.rates[0]);
    out->set(IMU_WY, imu.rates[1]);
    out->set(IMU_WZ, imu.rates[2]);
  }
  if (imu.force_covariance[0] >= 0) {
    out->set(IMU_X_ACC, imu.force[0]);
    out->set(IMU_Y_ACC, imu.force[1]);
    out->set(IMU_Z_ACC, imu.force[2]);
  }
  return out;
}

void BagImport::takeSensor(const BagMessage& message, const BagTopicParams& params) {
  const auto encoding = message.topic->encoding;
  SensorFrame frame;
  ros::Header header;
  frame.sensor = params.label;
  if (isCloud(message.topic->type)) {
    const auto cloud = ros::decoded<ros::PointCloud2>(message.bytes, encoding);
    using Kind = BagTopicParams::Kind;
    header = cloud.header;
    if (params.kind == Kind::kRadar || (params.kind == Kind::kAuto && ros::isOfRadar(cloud)))
      frame.data = ros::returnsOf(cloud, params.rate_scale);
    else
      frame.data = ros::cloudOf(cloud, params.intensity_max);
  } else if (isBoxes(message.topic->type)) {
    const auto boxes = ros::decoded<ros::Detection3DArray>(message.bytes, encoding);
    header = boxes.header;
    frame.data = ros::objectsOf(boxes);
  } else if (isRadar(message.topic->type)) {
    const auto scan = ros::decoded<ros::RadarScan>(message.bytes, encoding);
    header = scan.header;
    frame.data = ros::returnsOf(scan, params.rate_scale);
  } else {
    Raster raster;
    if (message.topic->type == "sensor_msgs/Image") {
      const auto image = ros::decoded<ros::Image>(message.bytes, encoding);
      header = image.header;
      raster = ros::rasterOf(image);
    } else {
      const auto image = ros::decoded<ros::CompressedImage>(message.bytes, encoding);
      header = image.header;
      raster = ros::rasterOf(image);
    }
    CameraImage image;
    if (const auto camera = cameraBeside(message.topic->name)) image.camera = *camera;
    image.camera.width = raster.width;
    image.camera.height = raster.height;
    image.load = [raster = std::move(raster)] { return raster; };
    frame.data = std::move(image);
  }
  if (header.stamp.ns <= 0) header.stamp = message.stamp;
  frame.stamp = header.stamp;
  frame.T_ego_sensor = mounting(header, params);
  if (message.topic->name == frames_topic_) {
    ++frame_;
    if (log_.wants(frame_))
      sorted(frame.stamp, [this, s = frame.stamp, n = frame_] { log_.frame(s, n); });
  }
  if (!log_.options().wants(std::max<std::int64_t>(frame_, 0))) return;
  sorted(frame.stamp, [this, frame = std::move(frame)] { log_.sensor(frame); });
}

void BagImport::take(const BagMessage& message) {
  const std::string& type = message.topic->type;
  const auto given = topic_params_.find(message.topic->name);
  BagTopicParams params = given == topic_params_.end() ? BagTopicParams() : given->second;
  if (!params.use || !message.topic->unknown_encoding.empty()) return;
  if (params.label.empty()) params.label = labelOf(message.topic->name);
  // Boxes may be another tracker's output: they are read when they are asked for.
  const bool boxes = isBoxes(type) && given != topic_params_.end();
  if (isCloud(type) || isRadar(type) || isImage(type) || boxes) return takeSensor(message, params);
  if (!log_.options().wants(std::max<std::int64_t>(frame_, 0))) return;
  if (type == "sensor_msgs/NavSatFix") {
    const auto fix = ros::decoded<ros::NavSatFix>(message.bytes, message.topic->encoding);
    if (fix.status < 0 || !std::isfinite(fix.latitude + fix.longitude)) return;
    const double altitude = std::isfinite(fix.altitude) ? fix.altitude : 0;
    auto out =
        gpsObservation({fix.header.stamp, fix.latitude, fix.longitude, altitude}, params.label);
    out->setSensorPose(toMrpt(mounting(fix.header, params)));
    sorted(fix.header.stamp, [this, out] { log_.observation(*out); });
  } else if (type == "sensor_msgs/Imu") {
    const auto imu = ros::decoded<ros::Imu>(message.bytes, message.topic->encoding);
    auto out = imuObservation(imu, params.label);
    out->setSensorPose(toMrpt(mounting(imu.header, params)));
    sorted(imu.header.stamp, [this, out] { log_.observation(*out); });
  }
}

void BagImport::readSensors() {
  for (const std::string& file : files_) {
    const auto bag = openBag(file);
    BagMessage message;
    while (bag->next(message)) {
      try {
        take(message);
      } catch (const std::bad_alloc&) {
        throw;
      } catch (const std::exception& e) {  // OpenCV's too
        if (dynamic_cast<const Error*>(&e) != nullptr) throw;
        auto& [count, first] = bad_[message.topic->name];
        if (count++ == 0) first = fmt::format("{}: byte {}: {}", file, message.offset, e.what());
      }
      flush(message.stamp + -kSorted);
      log_.progress(static_cast<std::int64_t>(bag->bytesRead()),
                    static_cast<std::int64_t>(bag->fileBytes()));
    }
  }
  flush({});
  if (last_) writePoses(*last_ + kBagPoseMargin);
}

/// "TOPIC of TYPE" of what may be a sensor's, by its name, and is not read.
std::vector<std::string> unreadSensors(const BagContents& contents) {
  constexpr const char* kHints[] = {"cloud", "points", "lidar",  "laser",    "scan",   "packet",
                                    "radar", "image",  "camera", "velodyne", "ouster", "livox"};
  std::vector<std::string> unread;
  for (const auto& [name, row] : contents.topics) {
    if (!useOfType(row.topic.type).empty()) continue;
    std::string text = name + " " + row.topic.type;
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (std::any_of(std::begin(kHints), std::end(kHints),
                    [&](const char* hint) { return text.find(hint) != std::string::npos; }))
      unread.push_back(fmt::format("{} of {}", name, row.topic.type));
  }
  return unread;
}

std::string unreadTopics(const BagContents& contents) {
  const auto unread = unreadSensors(contents);
  if (unread.empty()) return "";
  return fmt::format("; nothing here reads {}", fmt::join(unread, ", "));
}

void BagImport::run() {
  contents_ = readContents(files_, [](auto, auto) {});
  readParams();
  chooseBase();
  choosePoses();
  chooseFrames();
  if (frames_topic_.empty()) {
    throw DataError(
        fmt::format("{}: no topic of sensor_msgs/PointCloud2, Image, CompressedImage or "
                    "radar_msgs/RadarScan is used{} (--list names all topics)",
                    files_.front(), unreadTopics(contents_)),
        ExitCode::kNoInput);
  }
  readSensors();
  for (const std::string& fault : contents_.faults) log_.warn(fault);
  for (const std::string& topic : unreadSensors(contents_))
    log_.note(fmt::format("{}: not read", topic));
  for (const auto& [topic, fault] : bad_)
    log_.warn(fmt::format("{}: {} unreadable messages left out, the first: {}", topic, fault.first,
                          fault.second));
  for (const std::string& frame : unplaced_)
    log_.warn(
        fmt::format("frame \"{}\" has no transform to the vehicle's frame \"{}\": taken to be "
                    "there ([topic.TOPIC] pose says where it is)",
                    frame, base_));
  if (frame_ < 0)
    throw DataError(fmt::format("{}: no message of {} can be read: {}", files_.front(),
                                frames_topic_, bad_[frames_topic_].second));
}

class BagImporter final : public Importer {
 public:
  void declare(CLI::App& cli) override {
    cli.add_option("--bag", path_, "FILE.bag, FILE.mcap, or a folder of them")->required();
    cli.add_option("-c,--config", config_, "INI: [bag], [topic.TOPIC]; else all is found")
        ->type_name("INI");
    cli.add_flag("--list", list_, "prints the topics, writes nothing");
  }
  bool runInstead(const std::string&) override {
    if (!list_) return false;
    const BagContents contents = readContents(bagFiles(path_), [](auto, auto) {});
    fmt::print("{}", listOf(contents));
    for (const std::string& fault : contents.faults) fmt::print("damaged: {}\n", fault);
    return true;
  }
  void run(ImportLog& log) override {
    Config config =
        config_.empty() ? Config::fromText("", "(no --config)") : Config::fromFile(config_);
    BagImport(bagFiles(path_), config, log).run();
  }

 private:
  std::string path_, config_;
  bool list_ = false;
};

}  // namespace

std::unique_ptr<Importer> makeBagImporter() { return std::make_unique<BagImporter>(); }

}  // namespace perception
