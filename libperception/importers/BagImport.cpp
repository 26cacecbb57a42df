#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <set>

#include "libperception/core/Error.h"
#include "libperception/importers/BagContents.h"
#include "libperception/importers/BagMeasurements.h"
#include "libperception/importers/BagTypes.h"
#include "libperception/importers/Importer.h"
#include "libperception/interop/RosGraphParams.h"

namespace perception {
namespace {

/// [s] Messages are sorted by their stamps over this time of recording.
constexpr double kSorted = 1;
/// [s] Poses are written from this long before the first to this long after the last sensor data.
constexpr double kBagPoseMargin = 0.5;

/// The import of one recording.
class BagImport {
 public:
  BagImport(const std::string& path, Config& config, ImportLog& log)
      : path_(path),
        files_(bagFiles(path)),
        config_(config),
        log_(log),
        measurements_(contents_, topic_params_,
                      {[this](const std::string& topic, bool first, SensorFrame&& frame) {
                         takeFrame(topic, first, std::move(frame));
                       },
                       [this](Stamp stamp, std::shared_ptr<mrpt::obs::CObservation> observation) {
                         takeObservation(stamp, std::move(observation));
                       }}) {}
  void run();

 private:
  void readParams();
  void choosePoses();
  std::vector<StampedPose> posesOfTree() const;
  std::vector<StampedPose> posesOfTopic(const std::string& topic) const;
  void readSensors();
  void takeFrame(const std::string& topic, bool first, SensorFrame&& frame);
  void takeObservation(Stamp stamp, std::shared_ptr<mrpt::obs::CObservation> observation);
  bool isStray(const BagMessage& message);
  bool isWanted() const { return log_.options().wants(std::max<std::int64_t>(frame_, 0)); }
  void sorted(Stamp stamp, std::function<void()> write);
  void flush(std::optional<Stamp> until);
  void writePoses(Stamp until);
  void tellPoses();

  std::string path_;
  std::vector<std::string> files_;
  Config& config_;
  ImportLog& log_;
  BagParams params_;
  BagTopicParamsByName topic_params_;
  BagContents contents_;
  BagMeasurements measurements_;
  std::string base_;
  Pose3 T_ego_base_ = Pose3::Identity();
  std::string frames_topic_;  ///< whose messages are the frames
  std::int64_t frame_ = -1;
  std::vector<StampedPose> poses_;  ///< of the ego frame
  std::string poses_from_;          ///< whose; empty: none are taken
  std::size_t next_pose_ = 0, written_poses_ = 0;
  std::multimap<Stamp, std::function<void()>> queue_;
  std::optional<Stamp> last_;
  std::map<std::string, std::size_t> messages_;  ///< by topic: how many came
  std::map<std::string, std::pair<std::uint64_t, std::string>> bad_;
};

void BagImport::readParams() {
  params_ = config_.read<BagParams>("bag");
  config_.read<RosGraphParams>("ros");  // of running systems
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

/// Whether a message is of a time that its topic has left.
bool BagImport::isStray(const BagMessage& message) {
  const std::size_t number = messages_[message.topic->name]++;
  const auto clock = contents_.clocks.find(message.topic->name);
  return clock != contents_.clocks.end() && !clock->second.uses(number);
}

void BagImport::takeFrame(const std::string& topic, bool first, SensorFrame&& frame) {
  if (topic == frames_topic_ && first) {
    ++frame_;
    if (log_.wants(frame_))
      sorted(frame.stamp, [this, s = frame.stamp, n = frame_] { log_.frame(s, n); });
  }
  if (!isWanted()) return;
  sorted(frame.stamp, [this, frame = std::move(frame)] { log_.sensor(frame); });
}

void BagImport::takeObservation(Stamp stamp, std::shared_ptr<mrpt::obs::CObservation> observation) {
  if (!isWanted()) return;
  sorted(stamp, [this, observation] { log_.observation(*observation); });
}

void BagImport::readSensors() {
  for (const std::string& file : files_) {
    const auto bag = openBag(file);
    BagMessage message;
    while (bag->next(message)) {
      try {
        if (!isStray(message)) measurements_.take(message);
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
  measurements_.finish();
  flush({});
  if (last_) writePoses(*last_ + kBagPoseMargin);
}

void BagImport::run() {
  contents_ = readContents(path_);
  readParams();
  base_ = baseFrameOf(params_, contents_);
  measurements_.setBase(base_, T_ego_base_);
  choosePoses();
  frames_topic_ = framesTopicOf(topic_params_, contents_);
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
  for (const std::string& warning : measurements_.warnings()) log_.warn(warning);
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
