#pragma once
#include <chrono>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Time.h"
#include "libperception/dds/RosTopics.h"
#include "libperception/interop/ros/RosDisplay.h"
#include "libperception/pipeline/LogRun.h"
#include "libperception/scene/Scene.h"

namespace perception {

/// Where a run on `log` publishes, on INTERFACE[:DOMAIN]. Into a graph that sends the vehicle's
/// place itself ours does not come beside it. Throws Error.
RosTopics::Params rosTopicsFor(const std::string& network, const std::string& log,
                               const std::vector<std::string>& class_names);

/// Sends a run into a ROS 2 graph while it goes on: scenes and grid, and once a second how the
/// sensors and the run are (/diagnostics).
class RosView {
 public:
  /// Throws Error (kUnavailable).
  explicit RosView(RosTopics::Params params) : topics_(std::move(params)) {}

  /// An event of the run, as of EventLog::Listener.
  void onEvent(const nlohmann::ordered_json& content);
  void put(const Scene& scene, const LogRun& run);
  std::uint64_t missed() const { return topics_.missed(); }

 private:
  std::vector<ros::DiagnosticStatus> status(const Scene& scene, const LogRun& run) const;

  RosTopics topics_;
  std::map<std::string, ros::DiagnosticStatus> sensors_;  ///< by label
  std::string last_warning_;
  std::optional<std::chrono::steady_clock::time_point> warned_at_, told_at_;
};

}  // namespace perception
