#include "libperception/importers/BagContents.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "libperception/core/Error.h"
#include "libperception/importers/BagTypes.h"

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
  for (const std::string& file : bagFiles(path)) {
    const auto bag = openBag(file);
    BagMessage message;
    while (bag->next(message)) {
      BagContents::Row& row = contents.topics[message.topic->name];
      if (row.messages++ == 0) row.topic = *message.topic, row.first = message.stamp;
      row.first = std::min(row.first, message.stamp);
      row.last = std::max(row.last, message.stamp);
      try {
        const BagType* const type = bagType(message.topic->type);
        if (type != nullptr && type->note != nullptr && message.topic->unknown_encoding.empty())
          type->note(message, contents);
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
  for (auto& [topic, poses] : contents.poses)
    std::stable_sort(poses.poses.begin(), poses.poses.end(),
                     [](const auto& a, const auto& b) { return a.stamp < b.stamp; });
  return contents;
}

std::string useOfType(const std::string& type) {
  const BagType* const row = bagType(type);
  return row == nullptr ? "" : row->use;
}

std::vector<std::string> unreadTopics(const BagContents& contents) {
  std::vector<std::string> topics;
  for (const auto& [name, row] : contents.topics) {
    if (row.topic.unknown_encoding.empty() && !useOfType(row.topic.type).empty()) continue;
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
                                ? useOfType(row.topic.type)
                                : "not: encoding " + row.topic.unknown_encoding;
    text += fmt::format("{:<36} {:<30} {:>8} {:>8}  {}\n", name, row.topic.type, row.messages, rate,
                        use.empty() ? "not" : use);
    if (const std::string fields = fieldsOf(row.topic.definition); use.empty() && !fields.empty())
      text += fmt::format("{:<36} {}\n", "", fields);
  }
  return text;
}

}  // namespace perception
