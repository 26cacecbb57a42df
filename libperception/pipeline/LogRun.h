#pragma once
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libperception/pipeline/LogWatchers.h"
#include "libperception/pipeline/OutputFolder.h"
#include "libperception/pipeline/Pipeline.h"
#include "libperception/scene/KittiExport.h"
#include "libperception/scene/TrackedRun.h"
#include "libperception/sensors/RawlogReader.h"

namespace perception {

/// Where the results of one log go.
struct LogRunFiles {
  std::string log, dir;
  std::string export_file;  ///< KITTI's tracking format; empty: none
};

/// One log tracked into one folder of results: read() first, then finish() and commit(), each once.
class LogRun {
 public:
  /// Throws DataError for the log, OutputError and Error for the folder.
  LogRun(const PipelineSetup& setup, LogRunFiles files);

  /// Reads the log to its end; `keep` is called with each scene.
  void read(const std::function<void(const Scene&)>& keep);
  /// Judges how it went. Returns what there is to warn of; throws DataError when nothing came of
  /// it, or when the log is damaged and `strict`.
  std::vector<std::string> finish(bool strict);
  /// Fills the record's figures of the log and writes all that remains; then the folder is whole.
  void commit(const std::string& effective_ini, int threads);

  RunRecord record;  ///< program and configuration are the caller's
  double wallSeconds() const { return timing_.wallSeconds(); }
  double realTimeFactor() const;  ///< seconds of log per second of work

 private:
  void put(const Scene& scene);
  void writeExport(const Scene& scene);
  void fillRecord();
  double logSeconds() const { return pipeline_.lastStamp() - *pipeline_.firstStamp(); }

  const PipelineSetup setup_;
  const LogRunFiles files_;
  RawlogReader reader_;
  OutputFolder folder_;
  std::string written_to_;  ///< the folder's files until they are whole
  EventLog events_;
  RunTiming timing_;
  Pipeline pipeline_;
  ObjectEvents object_events_;
  LogFacts facts_;
  std::optional<MeasurementRecorder> recorder_;
  std::optional<TrackedRunWriter> writer_;
  std::optional<KittiExport> kitti_;
  std::vector<Scene> before_camera_;  ///< exports need a camera, and the log may show it late
};

}  // namespace perception
