#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/files/EventLog.h"
#include "libperception/scene/files/KittiExport.h"
#include "libperception/scene/files/MeasurementRun.h"

namespace perception {

/// Facts of a log that results need besides scenes: whether it is simulated, and the camera for
/// exports.
struct LogFacts {
  bool simulated = false;
  std::optional<std::string> weather;  ///< of a simulated log; "": clear air
  std::optional<KittiCamera> camera;

  void look(const mrpt::obs::CObservation& observation);
};

/// Writes events when objects appear and disappear, and counts them. Memory is bounded by
/// keepOnly().
class ObjectEvents {
 public:
  ObjectEvents(const ClassTable& classes, EventLog& events) : classes_(classes), events_(events) {}

  static constexpr std::size_t kFewIds = 1000;  ///< not worth forgetting

  void add(const Scene& scene);
  std::uint64_t objects() const { return objects_; }  ///< so far
  /// True once so many ids are known that keepOnly() is worth its time.
  bool isFull() const { return born_.size() >= full_; }
  /// Forgets the ids of all other objects, which must not come again.
  void keepOnly(const std::set<std::uint64_t>& ids);

 private:
  const ClassTable& classes_;
  EventLog& events_;
  std::uint64_t objects_ = 0;
  std::size_t full_ = kFewIds;
  std::set<std::uint64_t> born_, classified_, last_;
};

/// Writes the measurements of all scans to the filter (MeasurementRunWriter).
class MeasurementRecorder : public PipelineObserver {
 public:
  MeasurementRecorder(const std::string& dir, const Pipeline& pipeline)
      : pipeline_(pipeline), writer_(dir, pipeline.setup().model.classes) {}

  void onScan(const MeasurementScan& scan) override;
  void close() { writer_.close(); }

 private:
  const RecordedSensor& add(const MeasurementScan& scan);

  const Pipeline& pipeline_;
  MeasurementRunWriter writer_;
  std::map<std::string, RecordedSensor> sensors_;
};

}  // namespace perception
