#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/Scene.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/RunTiming.h"
#include "libperception/scene/files/TrackedRun.h"
#include "libperception/sensors/ego/EgoPose.h"

namespace perception {

/// A pipeline for programs whose observations do not come from a rawlog; they are added one by one.
/// Scenes are those of perception-track for the same observations in the same order. Any thread may
/// call; calls wait for each other.
class StreamTracker {
 public:
  /// `settings`: section.key=value, over the INI. `output`: folder of tracks.csv and scenes.csv;
  /// empty: none. Throws ConfigError.
  StreamTracker(const std::string& ini, const std::vector<std::string>& settings,
                std::string output);

  /// Throws Error (kUsage) after finish(), DataError for a stamp outside of 1970 to 2106.
  void add(const mrpt::obs::CObservation& observation);
  /// The oldest scene that is due and was not taken yet.
  std::optional<Scene> take();
  std::vector<Scene> takeAll();
  /// The stream has ended: what is left becomes due.
  void finish();

  /// Checks that an observation has a section [sensor.LABEL] and that its front end is one of
  /// `kinds`. Throws Error (kUsage), which names the sections that exist. Front ends that a program
  /// added take anything.
  void checkSensor(const std::string& label, const std::vector<std::string>& kinds) const;
  std::string eventLines() const;  ///< as in events.jsonl
  std::vector<std::string> learned() const;
  std::vector<std::string> classNames() const;
  std::vector<std::string> sensorLabels() const;
  const EgoPoseParams& ego() const { return pipeline_.setup().ego; }

 private:
  void drain(bool end);

  mutable std::mutex mutex_;
  EventLog events_;
  RunTiming timing_;
  Pipeline pipeline_;
  std::string output_;
  std::optional<TrackedRunWriter> writer_;
  std::deque<Scene> due_;
  bool finished_ = false;
};

}  // namespace perception
