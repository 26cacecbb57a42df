#include "libperception/python/StreamTracker.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {
namespace {

const std::vector<std::string> kShippedKinds = {"lidar", "boxes", "radar", "positions"};

bool holds(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

}  // namespace

StreamTracker::StreamTracker(const std::string& ini, const std::vector<std::string>& settings,
                             std::string output)
    : pipeline_(PipelineSetup::fromFile(ini, settings), events_, timing_),
      output_(std::move(output)) {
  if (output_.empty()) return;
  std::error_code fault;
  std::filesystem::create_directories(output_, fault);
  if (fault) throw OutputError(output_ + ": " + fault.message());
}

void StreamTracker::add(const mrpt::obs::CObservation& observation) {
  const std::lock_guard lock(mutex_);
  if (finished_) throw Error(ExitCode::kUsage, "the tracker has finished: it takes nothing more");
  if (!toStamp(observation.timestamp))
    throw DataError(observation.sensorLabel + ": the stamp is outside of the years 1970 to 2106");
  pipeline_.add(observation);
  drain(false);
}

void StreamTracker::drain(bool end) {
  while (auto scene = pipeline_.next(end)) {
    if (!output_.empty()) {
      if (!writer_)
        writer_.emplace(output_, pipeline_.setup().model.classes, *pipeline_.firstStamp());
      writer_->write(*scene);
    }
    due_.push_back(std::move(*scene));
  }
  // Rows of weather.csv and ledger.csv, which a stream does not write, must not pile up.
  pipeline_.takeWeather();
  pipeline_.takeLedger();
}

std::optional<Scene> StreamTracker::take() {
  const std::lock_guard lock(mutex_);
  if (due_.empty()) return std::nullopt;
  Scene scene = std::move(due_.front());
  due_.pop_front();
  return scene;
}

std::vector<Scene> StreamTracker::takeAll() {
  const std::lock_guard lock(mutex_);
  std::vector<Scene> scenes(std::make_move_iterator(due_.begin()),
                            std::make_move_iterator(due_.end()));
  due_.clear();
  return scenes;
}

void StreamTracker::finish() {
  const std::lock_guard lock(mutex_);
  if (finished_) return;
  finished_ = true;
  drain(true);
  pipeline_.finish();
  if (writer_) writer_->close();
}

void StreamTracker::checkSensor(const std::string& label,
                                const std::vector<std::string>& kinds) const {
  const PipelineSetup& setup = pipeline_.setup();
  const auto sensor = setup.sensorOf(label);
  if (!sensor)
    throw Error(ExitCode::kUsage,
                fmt::format("'{}': the configuration has no [sensor.{}]; it has {}", label, label,
                            fmt::join(sensorLabels(), ", ")));
  const std::string& kind = setup.sensors[*sensor].params.kind;
  if (holds(kShippedKinds, kind) && !holds(kinds, kind))
    throw Error(ExitCode::kUsage,
                fmt::format("'{}': [sensor.{}] has kind = {}, which does not take this data; "
                            "expected {}",
                            label, label, kind, fmt::join(kinds, " or ")));
}

std::string StreamTracker::eventLines() const {
  const std::lock_guard lock(mutex_);
  return events_.text(pipeline_.firstStamp().value_or(Stamp{}));
}

std::vector<std::string> StreamTracker::learned() const {
  const std::lock_guard lock(mutex_);
  return pipeline_.learned();
}

std::vector<std::string> StreamTracker::classNames() const {
  return pipeline_.setup().model.classes.names();
}

std::vector<std::string> StreamTracker::sensorLabels() const {
  std::vector<std::string> labels;
  for (const auto& sensor : pipeline_.setup().sensors) labels.push_back(sensor.label);
  return labels;
}

}  // namespace perception
