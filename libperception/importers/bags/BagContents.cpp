#include "libperception/importers/bags/BagContents.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <sstream>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/importers/bags/BagMeasurements.h"
#include "libperception/importers/messages/BagTypes.h"

namespace perception {
namespace {

constexpr const char* kPoseDoc = "x, y, z [m], yaw, pitch, roll [deg] on the vehicle";

/// The fields of a message's definition, those of its parts left out: "Header header, float32 x".
std::string fieldsOf(const std::string& definition) {
  std::istringstream lines(definition);
  std::string fields;
  for (std::string line; std::getline(lines, line);) {
    if (!line.empty() && line[0] == '=') break;  // types of the fields follow
    std::istringstream words(line.substr(0, line.find('#')));
    std::string type, name, next;
    words >> type >> name;
    const bool constant = name.find('=') != std::string::npos || (words >> next && next[0] == '=');
    if (!name.empty() && !constant) fields += (fields.empty() ? "" : ", ") + type + " " + name;
  }
  constexpr std::size_t kMost = 400;
  return fields.size() > kMost ? fields.substr(0, kMost) + " ..." : fields;
}

bool hasHeader(const BagTopic& topic) {
  const BagType* const type = bagType(topic);
  return type != nullptr && type->has_header;
}

/// Name of a frame's clock.
std::string transformsOf(const std::string& child) { return "transforms of \"" + child + "\""; }

/// What the headers of one topic's messages say.
struct TopicTimes {
  std::vector<MessageTimes> times;
  std::vector<std::uint16_t> frames;  ///< of each: numbers in BagContents::frames
};

void addHeader(const BagMessage& message, BagContents& contents, TopicTimes& topic) {
  topic.times.push_back({{}, message.stamp});
  topic.frames.push_back(0);
  const auto header = headerOf(message);
  if (!header) return;
  topic.times.back().measured = header->stamp;
  auto& frames = contents.frames[message.topic->name];
  const std::string name = frameName(header->frame_id);
  const auto at = std::find(frames.begin(), frames.end(), name);
  constexpr std::ptrdiff_t kMostFrames = std::numeric_limits<std::uint16_t>::max();
  topic.frames.back() = static_cast<std::uint16_t>(std::min(at - frames.begin(), kMostFrames));
  if (at == frames.end() && at - frames.begin() <= kMostFrames) frames.push_back(name);
}

/// The messages of each frame have their own order.
MessageClock clockOfTopic(const TopicTimes& topic) {
  const std::size_t most = *std::max_element(topic.frames.begin(), topic.frames.end());
  if (most == 0) return clockOf(topic.times);
  MessageClock all;
  all.used.assign(topic.times.size(), true);
  for (std::size_t frame = 0; frame <= most; ++frame) {
    std::vector<MessageTimes> times;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < topic.times.size(); ++i) {
      if (topic.frames[i] == frame) times.push_back(topic.times[i]), numbers.push_back(i);
    }
    const MessageClock clock = clockOf(times);
    for (std::size_t i = 0; i < numbers.size(); ++i) all.used[numbers[i]] = clock.used[i];
    all.left_out += clock.left_out, all.unstamped += clock.unstamped;
    all.farthest = std::max(all.farthest, clock.farthest);
    if (frame == 0) all.lead = clock.lead, all.resent = clock.resent;
  }
  return all;
}

/// The clocks of all that has stamps.
void findClocks(const std::map<std::string, TopicTimes>& topics, BagContents& contents) {
  for (const auto& [name, topic] : topics) {
    MessageClock clock = clockOfTopic(topic);
    // Boxes may come late because finding them took long.
    const BagType* const type = bagType(contents.topics.at(name).topic);
    if (type != nullptr && type->role == BagType::Role::kBoxes) clock.lead.reset();
    contents.clocks[name] = clock;
  }
  for (const auto& [child, transforms] : contents.transforms) {
    if (!transforms.fixed) contents.clocks[transformsOf(child)] = clockOf(transforms.times);
  }
  alignClocks(contents.clocks);
}

/// The frames' poses, those left out that their clock does not use.
void plantTree(BagContents& contents) {
  for (auto& [child, transforms] : contents.transforms) {
    const auto found = contents.clocks.find(transformsOf(child));
    const MessageClock clock = found == contents.clocks.end() ? MessageClock() : found->second;
    for (std::size_t i = 0; i < transforms.poses.size(); ++i) {
      if (!transforms.fixed && !clock.uses(i)) continue;
      const PoseSeries::Row row = transforms.poses.row(i);
      contents.tree.add(transforms.parent, child, row.stamp + (transforms.fixed ? 0 : clock.shift),
                        row.pose, transforms.fixed);
    }
    transforms = {};
  }
  contents.tree.settle();
  contents.transforms.clear();
}

/// The same for poses on topics; those in another frame of reference than the first are left out.
void cleanPoses(const std::map<std::string, TopicTimes>& topics, BagContents& contents) {
  for (auto& [name, poses] : contents.poses) {
    const auto topic = topics.find(name);
    const MessageClock clock = contents.clocks[name];
    PoseSeries used;
    std::size_t elsewhere = 0;
    for (std::size_t i = 0; i < poses.poses.size(); ++i) {
      const PoseSeries::Row pose = poses.poses.row(i);
      if (topic == topics.end()) {
        used.add(pose.stamp, pose.pose);
        continue;
      }
      const std::size_t message = poses.messages[i];
      if (topic->second.frames[message] > 0) ++elsewhere;
      if (topic->second.frames[message] == 0 && clock.uses(message))
        used.add(pose.stamp + clock.shift, pose.pose);
    }
    if (elsewhere > 0)
      contents.faults.push_back(
          fmt::format("{}: {} poses are in another frame than \"{}\": left out", name, elsewhere,
                      contents.frames[name].front()));
    used.sort();
    poses.poses = std::move(used);
  }
}

/// What the stamps and frames of the messages say that a user should know.
void tellClocks(BagContents& contents) {
  for (const auto& [source, clock] : contents.clocks) {
    for (const std::string& fault : faultsOf(source, clock)) contents.faults.push_back(fault);
    if (clock.unstamped > 0)
      contents.remarks.push_back(
          fmt::format("{}: {} of {} messages have no stamp: the time of recording is taken", source,
                      clock.unstamped, clock.used.size()));
  }
  for (const auto& [topic, frames] : contents.frames) {
    if (frames.size() > 1 && contents.poses.count(topic) == 0)
      contents.remarks.push_back(
          fmt::format("{}: messages in {} frames ({}): taken as a sensor each", topic,
                      frames.size(), fmt::join(frames, ", ")));
  }
  for (const auto& [topic, row] : contents.topics) {
    const std::string label = labelOfTopic(topic, contents);
    if (label != labelOfTopic(topic) && bagType(row.topic) != nullptr)
      contents.remarks.push_back(fmt::format("{}: another topic has the label {}: this one has {}",
                                             topic, labelOfTopic(topic), label));
  }
}

}  // namespace

void BagParams::visit(ParamVisitor& v) {
  v.text("base_frame", base_frame,
         "frame of the vehicle; empty: base_footprint, base_link, ego, or the one that moves");
  v.reals("base_pose", base_pose, -1, {-1000, 1000}, "", kPoseDoc);
  v.require(base_pose.empty() || base_pose.size() == 6, "base_pose: expected six numbers");
  v.text("poses", poses, "the vehicle's poses: tf, a topic, or none; empty: the first there is");
}

void BagTopicParams::visit(ParamVisitor& v) {
  v.text("label", label, "sensor label in the log; empty: the topic's name");
  v.reals("pose", pose, -1, {-1000, 1000}, "", kPoseDoc);
  v.require(pose.empty() || pose.size() == 6, "pose: expected six numbers");
  v.real("intensity_max", intensity_max, {0, 1e9}, "",
         "intensities are divided by it; 0: bytes by 255, others not");
  v.choiceOf("kind", kind, {"auto", "lidar", "radar"},
             "of what clouds are; auto: of a radar, if they have range rates and no beam numbers");
  v.real("rate_scale", rate_scale, {-1, 1}, "",
         "range rates of a radar are multiplied by it: -1 if they are positive where objects come "
         "nearer, 0 if they are none");
  v.boolean("use", use, "no: left out");
}

Pose3 poseOfNumbers(const std::vector<double>& p) {
  return makePose(p[0], p[1], p[2], radians(p[3]), radians(p[4]), radians(p[5]));
}

BagContents readContents(const std::string& path) {
  std::uint64_t messages = 0;
  BagContents contents;
  std::map<std::string, std::pair<std::uint64_t, std::string>> bad;  // by topic: messages, first
  std::map<std::string, TopicTimes> times;
  for (const std::string& file : bagFiles(path)) {
    const auto bag = openBag(file);
    BagMessage message;
    while (bag->next(message)) {
      BagContents::Row& row = contents.topics[message.topic->name];
      if (row.messages++ == 0) row.topic = *message.topic, row.first = message.stamp;
      row.first = std::min(row.first, message.stamp);
      row.last = std::max(row.last, message.stamp);
      try {
        if (hasHeader(*message.topic)) addHeader(message, contents, times[message.topic->name]);
        const BagType* const type = bagType(*message.topic);
        if (type != nullptr && type->note != nullptr) type->note(message, contents);
      } catch (const std::runtime_error& e) {
        if (dynamic_cast<const Error*>(&e) != nullptr) throw;
        auto& [count, first] = bad[message.topic->name];
        if (count++ == 0) first = fmt::format("{}: {}: {}", file, message.place(), e.what());
      }
      ++messages;
    }
    contents.faults.insert(contents.faults.end(), bag->faults().begin(), bag->faults().end());
  }
  if (const std::string fault = faultOfBagFolder(path, messages); !fault.empty())
    contents.faults.push_back(fault);
  for (const auto& [topic, fault] : bad)
    contents.faults.push_back(fmt::format("{}: {} unreadable messages left out, the first: {}",
                                          topic, fault.first, fault.second));
  findClocks(times, contents);
  plantTree(contents);
  cleanPoses(times, contents);
  tellClocks(contents);
  return contents;
}

std::optional<ros::Header> headerOf(const BagMessage& message) {
  if (!hasHeader(*message.topic)) return {};
  return ros::decoded<ros::Header>(message.bytes, message.topic->encoding);
}

std::string useOfTopic(const BagTopic& topic) {
  const BagType* const row = bagType(topic);
  return row == nullptr ? "" : row->use;
}

std::vector<std::string> unreadTopics(const BagContents& contents) {
  std::vector<std::string> topics;
  for (const auto& [name, row] : contents.topics) {
    if (!useOfTopic(row.topic).empty()) continue;
    const std::string fields = fieldsOf(row.topic.definition);
    topics.push_back(fmt::format(
        "not read: {}: {} messages of {}{}{}", name, row.messages, row.topic.type,
        row.topic.unknown_encoding.empty() ? "" : ", encoding " + row.topic.unknown_encoding,
        fields.empty() ? "" : ": " + fields));
  }
  return topics;
}

std::string listOf(const BagContents& contents) {
  std::string text =
      fmt::format("{:<36} {:<30} {:>8} {:>8}  {}\n", "topic", "type", "messages", "Hz", "read as");
  for (const auto& [name, row] : contents.topics) {
    const double seconds = row.last - row.first;
    const std::string rate =
        seconds > 0 ? fmt::format("{:.2f}", static_cast<double>(row.messages - 1) / seconds) : "";
    const std::string use = row.topic.unknown_encoding.empty()
                                ? useOfTopic(row.topic)
                                : "not: encoding " + row.topic.unknown_encoding;
    text += fmt::format("{:<36} {:<30} {:>8} {:>8}  {}\n", name, row.topic.type, row.messages, rate,
                        use.empty() ? "not" : use);
    if (const std::string fields = fieldsOf(row.topic.definition); use.empty() && !fields.empty())
      text += fmt::format("{:<36} {}\n", "", fields);
  }
  return text;
}

}  // namespace perception
