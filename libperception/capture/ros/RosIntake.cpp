#include "libperception/capture/ros/RosIntake.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <variant>

#include "libperception/core/Error.h"
#include "libperception/measurement/frames/NoReturns.h"
#include "libperception/measurement/frames/ScanTimes.h"
#include "libperception/sensors/frames/ToObservation.h"

namespace perception {
namespace {

// Bounds of what is held, whatever comes.
constexpr std::size_t kMostWaiting = 2000;              // messages of sensors
constexpr std::size_t kMostWaitingBytes = 500'000'000;  // of these
constexpr std::size_t kMostFrames = 1000;               // of reference
constexpr std::size_t kMostTimes = 1000;                // of a topic

/// Whether its messages become data of sensors or readings.
bool isOfSensor(const BagType& type) {
  return type.role != BagType::Role::kOther || type.observe != nullptr;
}

}  // namespace

BagTopic liveTopic(const std::string& topic, const std::string& type) {
  BagTopic row;
  row.name = topic, row.type = type, row.encoding = ros::Encoding::kCdr;
  return row;
}

RosIntake::RosIntake(Config& config, Give give)
    : bag_(config.read<BagParams>("bag")),
      graph_(config.read<RosGraphParams>("ros")),
      give_(std::move(give)),
      measurements_(contents_, topic_params_,
                    {[this](const std::string& topic, bool first, SensorFrame&& frame) {
                       giveFrame(topic, first, std::move(frame));
                     },
                     [this](Stamp, std::shared_ptr<mrpt::obs::CObservation> observation) {
                       give_(std::move(observation));
                     }}),
      poses_(contents_, bag_.poses, give_) {
  for (const std::string& section : config.sectionsWithPrefix("topic."))
    topic_params_[section.substr(std::string("topic.").size())] =
        config.read<BagTopicParams>(section);
  if (!bag_.poses.empty() && bag_.poses != "tf" && bag_.poses != "none" && bag_.poses[0] != '/')
    config.fault("bag", "poses", bag_.poses + ": expected tf, none or a topic, as /odom");
  config.finish();
}

bool RosIntake::wants(const std::string& topic, const std::string& type) const {
  return measurements_.uses(liveTopic(topic, type));
}

bool RosIntake::isLarge(const std::string& type) {
  const BagType* const row = bagType(liveTopic("", type));
  return row != nullptr && row->role != BagType::Role::kOther && row->unpack == nullptr;
}

std::uint64_t RosIntake::unreadable() const {
  std::uint64_t all = 0;
  for (const auto& row : topics_) all += row.second.unreadable;
  return all;
}

std::uint64_t RosIntake::late() const {
  std::uint64_t all = 0;
  for (const auto& row : topics_) all += row.second.late;
  return all;
}

/// A message that cannot be read is one that is lost, and no more.
void RosIntake::guarded(const std::string& topic, const std::function<void()>& work) {
  try {
    work();
  } catch (const std::exception& error) {  // OpenCV's too, and memory that a picture asks for
    Topic& row = topics_[topic];
    if (row.unreadable++ == 0) row.first_fault = error.what();
  }
}

void RosIntake::take(const std::string& topic, const std::string& type, std::string bytes,
                     Stamp received) {
  ++received_;
  BagContents::Row& row = contents_.topics[topic];
  if (row.messages++ == 0) {
    row.topic = liveTopic(topic, type);
    row.first = received;
  }
  row.last = received;
  guarded(topic, [&] {
    BagMessage message;
    message.topic = &row.topic, message.stamp = received, message.bytes = bytes;
    read(message, std::move(bytes));
  });
  tend(received);
}

/// `bytes`: those of the message.
void RosIntake::read(const BagMessage& message, std::string&& bytes) {
  const BagTopic& topic = *message.topic;
  const auto header = headerOf(message);
  if (header) noteHeader(message, *header);
  const BagType& type = *bagType(topic);
  if (type.note != nullptr) type.note(message, contents_);
  poses_.plant(message.stamp);
  if (!isOfSensor(type)) return;
  if (!began_) began_ = message.stamp;
  Waiting waiting{topic.name, {}, message.stamp, header.value_or(ros::Header{})};
  waiting.bytes = std::move(bytes);
  waiting_bytes_ += waiting.bytes.size();
  waiting_.push_back(std::move(waiting));
  while (waiting_.size() > kMostWaiting || waiting_bytes_ > kMostWaitingBytes) {
    waiting_bytes_ -= waiting_.front().bytes.size();
    waiting_.pop_front();
    ++left_out_;
  }
}

void RosIntake::noteHeader(const BagMessage& message, const ros::Header& header) {
  auto& frames = contents_.frames[message.topic->name];
  const std::string name = frameName(header.frame_id);
  if (frames.size() < kMostFrames && std::find(frames.begin(), frames.end(), name) == frames.end())
    frames.push_back(name);
  Topic& topic = topics_[message.topic->name];
  if (header.stamp.ns <= 0) return;
  if (topic.newest && header.stamp < *topic.newest && name == frames.front()) ++topic.late;
  topic.newest = header.stamp;
  topic.times.push_back({header.stamp, message.stamp});
  if (topic.times.size() > kMostTimes) topic.times.pop_front();
}

bool RosIntake::waitedSince(std::optional<Stamp> since, Stamp now) const {
  return since && now - *since >= graph_.patience;
}

void RosIntake::chooseBase(Stamp now) {
  if (has_base_) return;
  base_ = namedBaseFrameOf(bag_, contents_);
  if (base_.empty() && waitedSince(began_, now)) base_ = baseFrameOf(bag_, contents_);
  has_base_ = !base_.empty() || waitedSince(began_, now);
  if (!has_base_) return;
  const Pose3 T_ego_base =
      bag_.base_pose.empty() ? Pose3::Identity() : poseOfNumbers(bag_.base_pose);
  measurements_.setBase(base_, T_ego_base);
  poses_.setBase(base_, T_ego_base);
}

void RosIntake::tend(Stamp now) {
  chooseBase(now);
  for (;;) {
    // Poses go no further than the sensor data that waits, which would be late behind them.
    if (has_base_)
      poses_.give(now, waitedSince(began_, now),
                  waiting_.empty() ? Stamp{std::numeric_limits<std::int64_t>::max()}
                                   : waiting_.front().header.stamp);
    if (waiting_.empty() || !isReady(waiting_.front(), now)) return;
    const Waiting next = std::move(waiting_.front());
    waiting_.pop_front();
    waiting_bytes_ -= next.bytes.size();
    measure(next);
  }
}

bool RosIntake::isReady(const Waiting& waiting, Stamp now) {
  if (measurements_.isPlaced(waiting.topic, waiting.header)) return true;
  if (waiting.header.frame_id.empty() && has_base_) return true;
  const std::pair<std::string, std::string> source{waiting.topic, waiting.header.frame_id};
  if (given_up_.count(source)) return true;
  if (!waitedSince(waiting.received, now)) return false;
  if (given_up_.size() < kMostFrames) given_up_.insert(source);
  return true;
}

void RosIntake::measure(const Waiting& waiting) {
  guarded(waiting.topic, [&] {
    BagMessage message;
    message.topic = &contents_.topics.at(waiting.topic).topic;
    message.stamp = waiting.received, message.bytes = waiting.bytes;
    measurements_.take(message);
  });
}

void RosIntake::giveFrame(const std::string& topic, bool first, SensorFrame&& frame) {
  if (frames_topic_.empty()) frames_topic_ = framesTopicOf(topic_params_, contents_);
  if (topic == frames_topic_ && first) give_(frameComment(frame.stamp, ++frame_));
  if (doubles_.isDouble(frame)) return;
  auto* const cloud = std::get_if<LidarCloud>(&frame.data);
  if (cloud != nullptr) no_returns_[frame.sensor] += clear(noReturnsOf(*cloud), *cloud);
  if (cloud != nullptr && timesOutsideOf(*cloud)) {
    ++timeless_[frame.sensor];
    cloud->time_offset.clear();
  }
  give_(observationFromFrame(frame));
}

void RosIntake::finish() {
  if (const auto last = waiting_.empty() ? began_ : std::optional<Stamp>(waiting_.back().received))
    tend(*last + graph_.patience);
  while (!waiting_.empty()) {
    measure(waiting_.front());
    waiting_.pop_front();
  }
  waiting_bytes_ = 0;
  measurements_.finish();
}

std::vector<std::string> RosIntake::notes() const {
  std::vector<std::string> all;
  for (const auto& [name, row] : contents_.topics) {
    const double seconds = row.last - row.first;
    std::string line = fmt::format("{}: {} messages of {}", name, row.messages, row.topic.type);
    if (seconds > 0)
      line += fmt::format(", {:.2f} Hz", static_cast<double>(row.messages - 1) / seconds);
    const auto topic = topics_.find(name);
    if (topic != topics_.end() && !topic->second.times.empty()) {
      const auto& times = topic->second.times;
      const MessageClock clock = clockOf({times.begin(), times.end()});
      if (clock.lead) line += fmt::format(", came {:.3f} s after their stamps", -*clock.lead);
    }
    all.push_back(line);
  }
  all.push_back(poses_.note());
  for (const auto& [label, count] : doubles_.counts())
    all.push_back(fmt::format(
        "{}: {} messages came twice, with the same stamp and content: left out", label, count));
  for (const auto& [label, count] : no_returns_)
    if (count > 0)
      all.push_back(
          fmt::format("{}: {} points are no returns by their range: left out", label, count));
  return all;
}

std::vector<std::string> RosIntake::warnings() const {
  std::vector<std::string> all;
  std::map<std::string, MessageClock> clocks;
  for (const auto& [name, topic] : topics_) {
    clocks[name] = clockOf({topic.times.begin(), topic.times.end()});
    if (topic.unreadable > 0)
      all.push_back(fmt::format("{}: {} unreadable messages left out, the first: {}", name,
                                topic.unreadable, topic.first_fault));
    if (topic.late > 0)
      all.push_back(
          fmt::format("{}: {} messages were stamped before the one before", name, topic.late));
  }
  alignClocks(clocks);
  for (const auto& [name, clock] : clocks)
    if (clock.shift != 0)
      all.push_back(fmt::format(
          "{}: its clock is {:.3f} s {} this computer's, and other clocks are not: its stamps are "
          "taken as they are",
          name, std::abs(clock.shift), clock.shift < 0 ? "ahead of" : "behind"));
  if (left_out_ > 0)
    all.push_back(
        fmt::format("{} messages of sensors were left out: too many waited for the place "
                    "of a frame on the vehicle",
                    left_out_));
  for (const auto& [label, count] : timeless_)
    all.push_back(
        fmt::format("{}: returns lie more than {:g} s outside of {} of its scans: their times are "
                    "not used",
                    label, kLongestScan, count));
  if (const std::string fault = poses_.fault(); !fault.empty()) all.push_back(fault);
  for (const std::string& warning : measurements_.warnings()) all.push_back(warning);
  return all;
}

}  // namespace perception
