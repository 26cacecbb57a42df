#include "libperception/importers/TopicChecks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <variant>

namespace perception {
namespace {

/// [s] by which messages may come out of order.
constexpr double kOutOfOrder = 0.2;
/// [s] from a scan's stamp to its first or last return, at most: lidars turn once a second or
/// faster.
constexpr float kLongestScan = 1;

/// The greatest distance of a return's time from the stamp of its scan [s].
float greatestOffset(const SensorFrame& frame) {
  const auto* cloud = std::get_if<LidarCloud>(&frame.data);
  float greatest = 0;
  if (cloud == nullptr) return greatest;
  for (const float t : cloud->time_offset)
    greatest = std::max(greatest, std::isfinite(t) ? std::abs(t) : kLongestScan + 1);
  return greatest;
}

/// A frame of reference as a part of a label.
std::string wordOf(const std::string& reference) {
  std::string word;
  for (const char c : reference) word += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return word;
}

}  // namespace

bool TopicChecks::isFirstReference(const std::string& topic, const std::string& reference) const {
  const auto known = topics_.find(topic);
  return known == topics_.end() || known->second.references.front() == reference;
}

bool TopicChecks::take(const std::string& topic, const std::string& reference, SensorFrame& frame) {
  Topic& t = topics_[topic];
  if (t.references.empty()) t.label = frame.sensor;
  ++t.messages;
  if (std::find(t.references.begin(), t.references.end(), reference) == t.references.end())
    t.references.push_back(reference);
  const auto [newest, fresh] = t.newest.try_emplace(reference, frame.stamp);
  const double back = newest->second - frame.stamp;
  if (!fresh && back > kOutOfOrder) {
    if (t.before++ == 0) t.first_before = t.messages;
    t.jump = std::max(t.jump, back);
    return false;
  }
  newest->second = std::max(newest->second, frame.stamp);
  if (reference != t.references.front()) frame.sensor += "_" + wordOf(reference);
  const float outside = greatestOffset(frame);
  if (outside > kLongestScan) {
    std::get<LidarCloud>(frame.data).time_offset.clear();
    t.outside = std::max(t.outside, static_cast<double>(outside));
    ++t.untimed;
  }
  return true;
}

std::vector<std::string> TopicChecks::warnings() const {
  std::vector<std::string> out;
  for (const auto& [name, t] : topics_) {
    if (t.before > 0)
      out.push_back(fmt::format(
          "{}: time jumps back by {:.3f} s at message {}; {} messages that lie before what was "
          "there already are left out",
          name, t.jump, t.first_before, t.before));
    for (std::size_t i = 1; i < t.references.size(); ++i)
      out.push_back(fmt::format(
          "{}: messages of two frames of reference, \"{}\" and \"{}\": those of the second are "
          "sensor {}_{}",
          name, t.references.front(), t.references[i], t.label, wordOf(t.references[i])));
    if (t.untimed > 0)
      out.push_back(
          fmt::format("{}: {} scans have returns that are timed up to {:.1f} s outside of "
                      "them: the times of their returns are left out",
                      name, t.untimed, t.outside));
  }
  return out;
}

}  // namespace perception
