#include "libperception/pipeline/input/LogContents.h"

#include <fmt/format.h>
#include <mrpt/rtti/CObject.h>

#include <algorithm>

#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

/// Labels of a damaged log may be anything: memory is bounded.
constexpr std::size_t kMostKinds = 200;

/// A label of a damaged log must not reach the terminal as it is.
std::string shown(const std::string& label) {
  std::string out = label.substr(0, 60);
  for (char& c : out) {
    const auto u = static_cast<unsigned char>(c);
    if (u < 0x20 || u >= 0x7f) c = '?';
  }
  return out.empty() ? "(no label)" : out;
}

}  // namespace

void LogContents::look(const mrpt::obs::CObservation& observation) {
  const Kind kind{observation.sensorLabel, observation.GetRuntimeClass()->className};
  if (entries_.size() >= kMostKinds && entries_.count(kind) == 0) {
    ++others_;
    return;
  }
  Entry& entry = entries_[kind];
  ++entry.count;
  const auto stamp = toStamp(observation.timestamp);
  if (!stamp) return;
  first_ = std::min(first_.value_or(*stamp), *stamp);
  entry.first = std::min(entry.first.value_or(*stamp), *stamp);
  entry.last = std::max(entry.last.value_or(*stamp), *stamp);
}

std::string LogContents::text() const {
  std::string out;
  for (const auto& [kind, entry] : entries_) {
    out += fmt::format("{}{} ({}, {})", out.empty() ? "" : ", ", shown(kind.first), kind.second,
                       entry.count);
  }
  if (others_ > 0) out += fmt::format(", {} observations of other labels", others_);
  return out.empty() ? "no observation" : out;
}

std::vector<std::string> LogContents::columns() {
  return {"label", "class", "number", "rate/Hz", "from/s", "to/s"};
}

std::vector<std::vector<std::string>> LogContents::rows() const {
  std::vector<std::vector<std::string>> out;
  for (const auto& [kind, entry] : entries_) {
    out.push_back({shown(kind.first), kind.second, std::to_string(entry.count)});
    if (!entry.first) continue;
    const double span = *entry.last - *entry.first;
    const auto periods = static_cast<double>(entry.count - 1);
    out.back().push_back(span > 0 ? fmt::format("{:.2f}", periods / span) : "-");
    for (const Stamp& stamp : {*entry.first, *entry.last})
      out.back().push_back(fmt::format("{:.3f}", stamp - *first_));
  }
  return out;
}

std::string LogContents::table() const {
  constexpr int kWidths[] = {24, 34, 8, 9, 10, 10};
  const auto line = [&](const std::vector<std::string>& cells) {
    std::string text;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text += (i == 0 ? "" : " ");
      text += i < 2 ? fmt::format("{:{}}", cells[i], kWidths[i])
                    : fmt::format("{:>{}}", cells[i], kWidths[i]);
    }
    return text + '\n';
  };
  std::string out = line(columns());
  for (const auto& row : rows()) out += line(row);
  if (others_ > 0) out += fmt::format("{} observations of other labels\n", others_);
  return out;
}

std::string noSceneMessage(const std::string& log, const LogContents& contents,
                           const PipelineSetup& setup, const std::string& end_message) {
  std::string wanted;
  for (const auto& s : setup.sensors) {
    if (s.active)
      wanted += fmt::format("{}{} ({})", wanted.empty() ? "" : ", ", s.label, s.params.kind);
  }
  return fmt::format(
      "{}: no scene came of it: no usable frame of a sensor in use ({}). The log holds: {}. The "
      "configuration wants: {}. The log ended: {}",
      log, setup.run.sensors, contents.text(), wanted, end_message);
}

}  // namespace perception
