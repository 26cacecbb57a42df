#include "libperception/live/RosView.h"

#include <fmt/format.h>

#include "libperception/config/Config.h"
#include "libperception/interop/ros/RosGraphParams.h"
#include "libperception/pipeline/input/LiveInput.h"

namespace perception {
namespace {

constexpr std::chrono::seconds kBetweenDiagnostics{1};
constexpr std::chrono::seconds kWarningStays{5};

/// What an event says of a sensor; empty: nothing of its state.
std::optional<ros::DiagnosticStatus::Level> levelOf(const std::string& kind) {
  static const std::map<std::string, ros::DiagnosticStatus::Level> levels = {
      {"sensor_blind", ros::DiagnosticStatus::kError},
      {"sensor_lost", ros::DiagnosticStatus::kError},
      {"sensor_fouled", ros::DiagnosticStatus::kWarn},
      {"sensor_misaligned", ros::DiagnosticStatus::kWarn},
      {"sensor_back", ros::DiagnosticStatus::kOk}};
  const auto found = levels.find(kind);
  if (found == levels.end()) return {};
  return found->second;
}

std::string numberText(double value) { return fmt::format("{:.3f}", value); }

}  // namespace

RosTopics::Params rosTopicsFor(const std::string& network, const std::string& log,
                               const std::vector<std::string>& class_names) {
  RosTopics::Params params;
  params.network = NetworkName::parse(network);
  params.class_names = class_names;
  if (!isOfRosGraph(log)) return params;
  const std::string ini = rosGraphIniOf(log);
  Config config = ini.empty() ? Config::fromText("", "(no INI)") : Config::fromFile(ini);
  const auto graph = config.read<RosGraphParams>("ros");
  params.world_frame = graph.world_frame;
  params.transforms = graph.send_transforms;
  return params;
}

void RosView::onEvent(const nlohmann::ordered_json& content) {
  const std::string kind = content.value("kind", ""), message = content.value("message", "");
  if (content.value("severity", "") == "warning") {
    last_warning_ = message;
    warned_at_ = std::chrono::steady_clock::now();
  }
  const auto fields = content.find("fields");
  const auto level = levelOf(kind);
  if (!level || fields == content.end() || !fields->is_object()) return;
  const std::string sensor = fields->value("sensor", "");
  if (sensor.empty()) return;
  ros::DiagnosticStatus& status = sensors_[sensor];
  status.level = *level;
  status.name = "perception: sensor " + sensor;
  status.hardware_id = sensor;
  status.message = message;
}

std::vector<ros::DiagnosticStatus> RosView::status(const Scene& scene, const LogRun& run) const {
  std::vector<ros::DiagnosticStatus> all;
  ros::DiagnosticStatus tracker;
  tracker.name = "perception: tracker";
  const bool warned = warned_at_ && std::chrono::steady_clock::now() - *warned_at_ < kWarningStays;
  tracker.level = warned ? ros::DiagnosticStatus::kWarn : ros::DiagnosticStatus::kOk;
  tracker.message = warned ? last_warning_ : "works";
  tracker.values = {{"objects", std::to_string(scene.objects.size())}};
  if (const auto latency = run.latency())
    tracker.values.push_back({"latency [s]", numberText(*latency)});
  all.push_back(tracker);
  if (scene.path) {
    const FreePath& path = *scene.path;
    ros::DiagnosticStatus way;
    way.name = "perception: way ahead";
    way.level = path.stop       ? ros::DiagnosticStatus::kError
                : path.too_fast ? ros::DiagnosticStatus::kWarn
                                : ros::DiagnosticStatus::kOk;
    way.message = path.stop ? "stop" : path.too_fast ? "faster than can be stopped" : "free";
    way.values = {{"free [m]", numberText(path.distance)},
                  {"seen [m]", numberText(path.seen)},
                  {"safe speed [m/s]", numberText(path.safe_speed)}};
    all.push_back(way);
  }
  for (const auto& row : sensors_) all.push_back(row.second);
  return all;
}

void RosView::put(const Scene& scene, const LogRun& run) {
  topics_.publish(scene);
  topics_.publish(scene, run.grid());
  const auto now = std::chrono::steady_clock::now();
  if (told_at_ && now - *told_at_ < kBetweenDiagnostics) return;
  told_at_ = now;
  topics_.publish(scene.stamp, status(scene, run));
}

}  // namespace perception
