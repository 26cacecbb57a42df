#include "libperception/importers/bags/BagChoices.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/interop/ros/RosGraphParams.h"

namespace perception {
namespace {

void readTopicParams(const BagContents& contents, Config& config, BagChoices& choices) {
  std::vector<std::string> names;
  for (const auto& row : contents.topics) names.push_back(row.first);
  for (const std::string& section : config.sectionsWithPrefix("topic.")) {
    const std::string topic = section.substr(std::string("topic.").size());
    choices.topics[topic] = config.read<BagTopicParams>(section);
    if (contents.topics.count(topic) == 0)
      config.fault(
          section, "",
          fmt::format("the recording has no such topic; there are: {}", fmt::join(names, " ")));
  }
}

BagParams readBagParams(const BagContents& contents, Config& config, BagChoices& choices) {
  auto params = config.read<BagParams>("bag");
  config.read<RosGraphParams>("ros");  // of running systems
  readTopicParams(contents, config, choices);
  const std::string& poses = params.poses;
  if (!poses.empty() && poses != "tf" && poses != "none" && contents.poses.count(poses) == 0)
    config.fault("bag", "poses", poses + ": expected tf, none or a topic with poses");
  if (!params.base_frame.empty() && !contents.tree.has(params.base_frame))
    config.fault("bag", "base_frame", params.base_frame + ": the recording has no such frame");
  config.finish();
  return params;
}

PoseSeries posesOfTree(const BagContents& contents, const BagChoices& choices) {
  PoseSeries poses;
  const std::string world = contents.tree.movesIn(choices.base);
  const PoseSeries* const step = contents.tree.movingStep(choices.base);
  for (std::size_t i = 0; step != nullptr && i < step->size(); ++i) {
    const Stamp stamp = step->row(i).stamp;
    if (const auto T = contents.tree.at(world, choices.base, stamp))
      poses.add(stamp, *T * choices.T_ego_base.inverse());
  }
  return poses;
}

PoseSeries posesOfTopic(const BagContents& contents, const BagChoices& choices,
                        const std::string& topic) {
  const BagContents::Poses& given = contents.poses.at(topic);
  PoseSeries poses;
  for (std::size_t i = 0; i < given.poses.size(); ++i) {
    const PoseSeries::Row pose = given.poses.row(i);
    const auto T_pose_base = given.frame.empty() || given.frame == choices.base
                                 ? std::optional<Pose3>(Pose3::Identity())
                                 : contents.tree.at(given.frame, choices.base, pose.stamp);
    poses.add(pose.stamp,
              pose.pose * T_pose_base.value_or(Pose3::Identity()) * choices.T_ego_base.inverse());
  }
  return poses;
}

void choosePoses(const BagContents& contents, const BagParams& params, BagChoices& choices,
                 ImportLog& log) {
  std::string source = params.poses;
  if (source.empty() && !contents.tree.movesIn(choices.base).empty()) source = "tf";
  for (const auto& [topic, poses] : contents.poses) {
    if (source.empty() && !poses.on_call) source = topic;
  }
  if (source.empty() || source == "none") {
    log.note("no poses are taken: they are found from GPS and inertial unit, or by odometry");
    return;
  }
  choices.poses =
      source == "tf" ? posesOfTree(contents, choices) : posesOfTopic(contents, choices, source);
  if (source == "tf" && choices.poses.empty()) {
    std::string others;
    for (const auto& row : contents.poses) others += " " + row.first;
    throw ConfigError(
        fmt::format("[bag] poses: tf: no transform of the recording moves \"{}\", "
                    "expected none{}{}",
                    choices.base, others.empty() ? "" : " or a topic with poses:", others));
  }
  choices.poses_from =
      source == "tf" ? "tf, in \"" + contents.tree.movesIn(choices.base) + "\"" : source;
}

}  // namespace

BagChoices chooseFrom(const BagContents& contents, Config& config, ImportLog& log) {
  BagChoices choices;
  const BagParams params = readBagParams(contents, config, choices);
  if (!params.base_pose.empty()) choices.T_ego_base = poseOfNumbers(params.base_pose);
  choices.base = baseFrameOf(params, contents);
  choosePoses(contents, params, choices, log);
  choices.frames_topic = framesTopicOf(choices.topics, contents);
  return choices;
}

void plantPoses(const BagChoices& choices, BagContents& contents) {
  const auto is_needed = [&](const std::string& world) {
    return std::any_of(contents.frames.begin(), contents.frames.end(), [&](const auto& row) {
      const auto& [topic, frames] = row;
      return contents.poses.count(topic) == 0 &&
             std::find(frames.begin(), frames.end(), world) != frames.end();
    });
  };
  for (const auto& [topic, given] : contents.poses) {
    const auto frames = contents.frames.find(topic);
    if (given.poses.empty() || frames == contents.frames.end()) continue;
    const std::string world = frames->second.front(), root = contents.tree.rootOf(choices.base);
    if (world.empty() || world == choices.base ||
        contents.tree.at(world, choices.base, given.poses.row(0).stamp) || !is_needed(world))
      continue;
    const PoseSeries poses = posesOfTopic(contents, choices, topic);
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const PoseSeries::Row row = poses.row(i);
      if (const auto T_base_root = contents.tree.at(choices.base, root, row.stamp))
        contents.tree.add(world, root, row.stamp, row.pose * choices.T_ego_base * *T_base_root,
                          false);
    }
    contents.tree.settle();
  }
}

}  // namespace perception
