#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "libperception/config/Config.h"
#include "libperception/core/Error.h"
#include "libperception/importers/Importer.h"
#include "libperception/importers/bags/BagChoices.h"
#include "libperception/importers/bags/BagContents.h"
#include "libperception/importers/bags/BagMeasurements.h"
#include "libperception/importers/bags/BagQueue.h"
#include "libperception/importers/messages/BagTypes.h"
#include "libperception/interop/bags/ReadingBag.h"

namespace perception {
namespace {

/// Reads the sensors' data of a recording, one message after the other.
class BagReading {
 public:
  BagReading(const BagContents& contents, const BagChoices& choices, ImportLog& log)
      : contents_(contents),
        choices_(choices),
        log_(log),
        queue_(choices, log),
        measurements_(contents, choices.topics,
                      {[this](const std::string& topic, bool first, SensorFrame&& frame) {
                         takeFrame(topic, first, std::move(frame));
                       },
                       [this](Stamp stamp, BagObservation observation) {
                         takeObservation(stamp, std::move(observation));
                       }}) {
    measurements_.setBase(choices.base, choices.T_ego_base);
  }

  void readAll(const std::vector<std::string>& files);
  /// What was left out or assumed.
  void tell() const;
  /// How many messages of the topic with the frames were read.
  std::int64_t frames() const { return frame_ + 1; }
  /// The first of a topic that could not be read.
  std::string faultOf(const std::string& topic) const {
    const auto fault = bad_.find(topic);
    return fault == bad_.end() ? "" : fault->second.second;
  }

 private:
  void take(const BagMessage& message, const std::string& file);
  void takeFrame(const std::string& topic, bool first, SensorFrame&& frame);
  void takeObservation(Stamp stamp, BagObservation observation);
  bool isStray(const BagMessage& message);
  bool isWanted() const { return log_.options().wants(std::max<std::int64_t>(frame_, 0)); }

  const BagContents& contents_;
  const BagChoices& choices_;
  ImportLog& log_;
  BagQueue queue_;
  BagMeasurements measurements_;
  std::int64_t frame_ = -1;
  std::map<std::string, std::size_t> messages_;  ///< by topic: how many came
  std::map<std::string, std::pair<std::uint64_t, std::string>> bad_;
};

/// Whether a message is of a time that its topic has left.
bool BagReading::isStray(const BagMessage& message) {
  const std::size_t number = messages_[message.topic->name]++;
  const auto clock = contents_.clocks.find(message.topic->name);
  return clock != contents_.clocks.end() && !clock->second.uses(number);
}

/// A message that cannot be read is left out and counted.
void BagReading::take(const BagMessage& message, const std::string& file) {
  try {
    if (!isStray(message)) measurements_.take(message);
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {  // OpenCV's too
    if (dynamic_cast<const Error*>(&e) != nullptr) throw;
    auto& [count, first] = bad_[message.topic->name];
    if (count++ == 0) first = fmt::format("{}: {}: {}", file, message.place(), e.what());
  }
}

void BagReading::takeFrame(const std::string& topic, bool first, SensorFrame&& frame) {
  const auto clock = contents_.clocks.find(topic);
  if (log_.isResent(frame, clock == contents_.clocks.end() ? 0 : clock->second.resent)) return;
  if (topic == choices_.frames_topic && first) {
    ++frame_;
    if (log_.wants(frame_))
      queue_.add(frame.stamp, [this, s = frame.stamp, n = frame_] { log_.frame(s, n); });
  }
  if (!isWanted()) return;
  queue_.add(frame.stamp, [this, frame = std::move(frame)] { log_.uniqueSensor(frame); });
}

void BagReading::takeObservation(Stamp stamp, BagObservation observation) {
  if (!isWanted()) return;
  queue_.add(stamp, [this, observation] { log_.observation(*observation); });
}

void BagReading::readAll(const std::vector<std::string>& files) {
  for (const std::string& file : files) {
    const auto bag = openBag(file);
    for (BagMessage message; bag->next(message);) {
      take(message, file);
      queue_.passed(message.stamp);
      log_.progress(static_cast<std::int64_t>(bag->bytesRead()),
                    static_cast<std::int64_t>(bag->fileBytes()));
    }
  }
  measurements_.finish();
  queue_.finish();
  queue_.tellPoses();
}

void BagReading::tell() const {
  for (const auto& [topic, fault] : bad_)
    log_.warn(fmt::format("{}: {} unreadable messages left out, the first: {}", topic, fault.first,
                          fault.second));
  for (const std::string& note : measurements_.notes()) log_.note(note);
  for (const std::string& warning : measurements_.warnings()) log_.warn(warning);
}

/// The recording is read twice: for what it holds, then for its sensors' data.
void importBag(const std::string& path, Config& config, ImportLog& log) {
  const auto files = bagFiles(path);
  BagContents contents = readContents(path);
  const BagChoices choices = chooseFrom(contents, config, log);
  plantPoses(choices, contents);
  if (choices.frames_topic.empty()) {
    throw DataError(fmt::format("{}: no topic of sensor_msgs/PointCloud2, Image, CompressedImage, "
                                "radar_msgs/RadarScan or of a lidar's packets is used: {}",
                                files.front(), fmt::join(unreadTopics(contents), "; ")),
                    ExitCode::kNoInput);
  }
  BagReading reading(contents, choices, log);
  reading.readAll(files);
  for (const std::string& topic : unreadTopics(contents)) log.note(topic);
  for (const std::string& remark : contents.remarks) log.note(remark);
  for (const std::string& fault : contents.faults) log.warn(fault);
  reading.tell();
  if (reading.frames() == 0)
    throw DataError(fmt::format("{}: no message of {} can be read: {}", files.front(),
                                choices.frames_topic, reading.faultOf(choices.frames_topic)));
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
    importBag(path_, config, log);
  }

 private:
  std::string path_, config_;
  bool list_ = false;
};

}  // namespace

std::unique_ptr<Importer> makeBagImporter() { return std::make_unique<BagImporter>(); }

}  // namespace perception
