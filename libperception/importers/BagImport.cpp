#include <fmt/format.h>
#include <fmt/ranges.h>
#include <mrpt/obs/CObservationIMU.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <string_view>

#include "libperception/core/Error.h"
#include "libperception/importers/BagContents.h"
#include "libperception/importers/BagPackets.h"
#include "libperception/importers/BagTypes.h"
#include "libperception/importers/ImportGps.h"
#include "libperception/importers/Importer.h"
#include "libperception/interop/RosSensors.h"
#include "libperception/sensors/Conversions.h"

namespace perception {
namespace {

/// [s] Messages are sorted by their stamps over this time of recording.
constexpr double kSorted = 1;
/// [s] Poses are written from this long before the first to this long after the last sensor data.
constexpr double kBagPoseMargin = 0.5;

BagType::Role roleOf(const BagTopic& topic) {
  const BagType* const type = bagType(topic.type);
  return type != nullptr && topic.unknown_encoding.empty() ? type->role : BagType::Role::kOther;
}

bool isOuster(const BagTopic& topic) {
  constexpr std::string_view kEnd = "/PacketMsg";
  return topic.type.size() > kEnd.size() &&
         topic.type.substr(topic.type.size() - kEnd.size()) == kEnd;
}

/// "/camera/image_raw" as the label of a section: camera_image_raw.
std::string labelOf(const std::string& topic) {
  std::string label = topic.substr(
      topic.find_first_not_of('/') == std::string::npos ? 0 : topic.find_first_not_of('/'));
  for (const char separator : {'/', '.'}) std::replace(label.begin(), label.end(), separator, '_');
  return label;
}

/// The import of one recording.
class BagImport {
 public:
  BagImport(const std::string& path, Config& config, ImportLog& log)
      : path_(path), files_(bagFiles(path)), config_(config), log_(log) {}
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
  std::string metadataFor(const std::string& topic) const;
  void takeFrame(const std::string& topic, const ros::Header& header, const BagTopicParams& params,
                 SensorFrame&& frame);
  std::shared_ptr<mrpt::obs::CObservation> imuObservation(const ros::Imu& imu,
                                                          const std::string& label);
  Pose3 mounting(const ros::Header& header, const BagTopicParams& params);
  double shiftOf(const BagMessage& message) const;
  bool isStray(const BagMessage& message);
  std::string otherFrame(const std::string& topic, const ros::Header& header) const;
  std::optional<CameraModel> cameraBeside(const std::string& topic) const;
  void sorted(Stamp stamp, std::function<void()> write);
  void flush(std::optional<Stamp> until);
  void writePoses(Stamp until);
  void tellPoses();

  std::string path_;
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
  std::string poses_from_;          ///< whose; empty: none are taken
  std::size_t next_pose_ = 0, written_poses_ = 0;
  std::multimap<Stamp, std::function<void()>> queue_;
  std::optional<Stamp> last_;
  std::map<std::string, std::unique_ptr<BagPackets>> packets_;  ///< by topic
  std::map<std::string, std::size_t> messages_;                 ///< by topic: how many came
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
  for (const auto& [topic, poses] : contents_.poses) {
    if (source.empty() && !poses.on_call) source = topic;
  }
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
  poses_from_ = source == "tf" ? "tf, in \"" + contents_.tree.movesIn(base_) + "\"" : source;
}

/// What was written is what is said: sensors and poses may have clocks that differ.
void BagImport::tellPoses() {
  if (poses_from_.empty()) return;
  const std::string of = fmt::format("of frame \"{}\" from {}", base_, poses_from_);
  if (poses_.empty() || written_poses_ > 0) {
    log_.note(fmt::format("poses: {} {}", written_poses_, of));
    return;
  }
  log_.warn(
      fmt::format("poses: none of the {} {} lies within the time of the sensors: theirs are "
                  "{:.3f} to {:.3f} s, the last sensor's is {:.3f} s; do the clocks differ?",
                  poses_.size(), of, poses_.front().stamp.seconds(), poses_.back().stamp.seconds(),
                  last_ ? last_->seconds() : 0));
}

/// The frames are the scans of the first cloud topic, else of the first radar, else the images of
/// the first camera, else the boxes of the first detector.
void BagImport::chooseFrames() {
  using Role = BagType::Role;
  for (const Role wanted : {Role::kCloud, Role::kRadar, Role::kImage, Role::kBoxes}) {
    for (const auto& [name, row] : contents_.topics) {
      const auto params = topic_params_.find(name);
      const bool used = params == topic_params_.end() ? wanted != Role::kBoxes : params->second.use;
      const bool silent = isOuster(row.topic) && contents_.lidar_packets.count(name) == 0;
      if (frames_topic_.empty() && used && !silent && roleOf(row.topic) == wanted)
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
    if (!last_ && until - pose.stamp >= kBagPoseMargin) continue;
    log_.ego(pose.stamp, pose.pose);
    ++written_poses_;
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
  const std::string frame = frameName(header.frame_id);
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

/// A sensor's message, or a part of one turn of a lidar in packets.
void BagImport::takeSensor(const BagMessage& message, const BagTopicParams& params) {
  const BagType& type = *bagType(message.topic->type);
  if (type.unpack != nullptr) {
    auto& packets = packets_[message.topic->name];
    if (!packets)
      packets = std::make_unique<BagPackets>(
          type, params.label, metadataFor(message.topic->name),
          [this, params, topic = message.topic->name, shift = shiftOf(message)](
              ros::Header header, SensorFrame&& scan) {
            header.stamp = header.stamp + shift;
            takeFrame(topic, header, params, std::move(scan));
          });
    return packets->add(message);
  }
  SensorFrame frame;
  ros::Header header = type.measure(message, params, frame);
  header.stamp = header.stamp.ns <= 0 ? message.stamp : header.stamp + shiftOf(message);
  if (auto* const image = std::get_if<CameraImage>(&frame.data)) {
    const CameraModel own = image->camera;
    image->camera = cameraBeside(message.topic->name).value_or(own);
    image->camera.width = own.width, image->camera.height = own.height;
  }
  takeFrame(message.topic->name, header, params, std::move(frame));
}

/// The metadata topic with the longest beginning in common.
std::string BagImport::metadataFor(const std::string& topic) const {
  std::string best;
  std::size_t longest = 0;
  for (const auto& [name, text] : contents_.metadata) {
    const auto common = static_cast<std::size_t>(
        std::mismatch(name.begin(), name.end(), topic.begin(), topic.end()).first - name.begin());
    if (best.empty() || common > longest) best = text, longest = common;
  }
  return best;
}

/// [s] to be added to a message's stamp.
double BagImport::shiftOf(const BagMessage& message) const {
  const auto clock = contents_.clocks.find(message.topic->name);
  return clock == contents_.clocks.end() ? 0 : clock->second.shift;
}

/// Whether a message is of a time that its topic has left.
bool BagImport::isStray(const BagMessage& message) {
  const std::size_t number = messages_[message.topic->name]++;
  const auto clock = contents_.clocks.find(message.topic->name);
  return clock != contents_.clocks.end() && !clock->second.uses(number);
}

/// A frame of reference besides the first one of the topic; empty: it is the first.
std::string BagImport::otherFrame(const std::string& topic, const ros::Header& header) const {
  const auto frames = contents_.frames.find(topic);
  const std::string name = frameName(header.frame_id);
  const bool first = frames == contents_.frames.end() || frames->second.front() == name;
  return first ? "" : name.empty() ? "without_frame" : name;
}

void BagImport::takeFrame(const std::string& topic, const ros::Header& header,
                          const BagTopicParams& params, SensorFrame&& frame) {
  const std::string other = otherFrame(topic, header);
  frame.sensor = other.empty() ? params.label : params.label + "_" + labelOf(other);
  frame.stamp = header.stamp;
  frame.T_ego_sensor = mounting(header, params);
  if (topic == frames_topic_ && other.empty()) {
    ++frame_;
    if (log_.wants(frame_))
      sorted(frame.stamp, [this, s = frame.stamp, n = frame_] { log_.frame(s, n); });
  }
  if (!log_.options().wants(std::max<std::int64_t>(frame_, 0))) return;
  sorted(frame.stamp, [this, frame = std::move(frame)] { log_.sensor(frame); });
}

void BagImport::take(const BagMessage& message) {
  const std::string& type = message.topic->type;
  if (isStray(message)) return;
  const auto given = topic_params_.find(message.topic->name);
  BagTopicParams params = given == topic_params_.end() ? BagTopicParams() : given->second;
  if (!params.use || !message.topic->unknown_encoding.empty()) return;
  if (params.label.empty()) params.label = labelOf(message.topic->name);
  // Boxes may be another tracker's output: they are read when they are asked for.
  const BagType::Role role = roleOf(*message.topic);
  if (role == BagType::Role::kBoxes && given == topic_params_.end()) return;
  if (role != BagType::Role::kOther) return takeSensor(message, params);
  if (!log_.options().wants(std::max<std::int64_t>(frame_, 0))) return;
  if (type == "sensor_msgs/NavSatFix") {
    auto fix = ros::decoded<ros::NavSatFix>(message.bytes, message.topic->encoding);
    fix.header.stamp = fix.header.stamp + shiftOf(message);
    if (fix.status < 0 || !std::isfinite(fix.latitude + fix.longitude)) return;
    const double altitude = std::isfinite(fix.altitude) ? fix.altitude : 0;
    auto out =
        gpsObservation({fix.header.stamp, fix.latitude, fix.longitude, altitude}, params.label);
    out->setSensorPose(toMrpt(mounting(fix.header, params)));
    sorted(fix.header.stamp, [this, out] { log_.observation(*out); });
  } else if (type == "sensor_msgs/Imu") {
    auto imu = ros::decoded<ros::Imu>(message.bytes, message.topic->encoding);
    imu.header.stamp = imu.header.stamp + shiftOf(message);
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
        if (count++ == 0) first = fmt::format("{}: {}: {}", file, message.place(), e.what());
      }
      flush(message.stamp + -kSorted);
      log_.progress(static_cast<std::int64_t>(bag->bytesRead()),
                    static_cast<std::int64_t>(bag->fileBytes()));
    }
  }
  for (const auto& row : packets_) {
    row.second->finish();
    for (const std::string& warning : row.second->warnings()) log_.warn(warning);
  }
  flush({});
  if (last_) writePoses(*last_ + kBagPoseMargin);
}

void BagImport::run() {
  contents_ = readContents(path_);
  readParams();
  chooseBase();
  choosePoses();
  chooseFrames();
  if (frames_topic_.empty()) {
    throw DataError(fmt::format("{}: no topic of sensor_msgs/PointCloud2, Image, CompressedImage, "
                                "radar_msgs/RadarScan or of a lidar's packets is used: {}",
                                files_.front(), fmt::join(unreadTopics(contents_), "; ")),
                    ExitCode::kNoInput);
  }
  readSensors();
  tellPoses();
  for (const std::string& topic : unreadTopics(contents_)) log_.note(topic);
  for (const std::string& remark : contents_.remarks) log_.note(remark);
  for (const std::string& fault : contents_.faults) log_.warn(fault);
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
    cli.add_option("--bag", path_, "FILE.bag, FILE.mcap, FILE.db3, or a folder of them")
        ->required();
    cli.add_option("-c,--config", config_, "INI: [bag], [topic.TOPIC]; else all is found")
        ->type_name("INI");
    cli.add_flag("--list", list_, "prints the topics, writes nothing");
  }
  bool runInstead(const std::string&) override {
    if (!list_) return false;
    const BagContents contents = readContents(path_);
    fmt::print("{}", listOf(contents));
    for (const std::string& remark : contents.remarks) fmt::print("{}\n", remark);
    for (const std::string& fault : contents.faults) fmt::print("damaged: {}\n", fault);
    return true;
  }
  void run(ImportLog& log) override {
    Config config =
        config_.empty() ? Config::fromText("", "(no --config)") : Config::fromFile(config_);
    BagImport(path_, config, log).run();
  }

 private:
  std::string path_, config_;
  bool list_ = false;
};

}  // namespace

std::unique_ptr<Importer> makeBagImporter() { return std::make_unique<BagImporter>(); }

}  // namespace perception
