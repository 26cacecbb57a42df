#pragma once
#include <functional>
#include <string>
#include <vector>

#include "libperception/app/App.h"
#include "libperception/core/system/SpoolFile.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/pictures/pages/ReportData.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {

/// perception-report: HTML page of a run, from the results of the other programs in its folder, or
/// of what differs between two runs.
class ReportApp : public App {
 public:
  ReportApp()
      : App("perception-report",
            "Makes one HTML page of a run: video, pictures, timeline, metrics, inputs; or of what "
            "differs between two.") {}

  std::string run_dir;         ///< -r: folder of perception-track
  std::string evaluation_dir;  ///< --evaluation; empty: evaluation/ of the run, when it is there
  std::string truth_file;      ///< -t; empty: LOG.truth.csv beside the log, when it is there
  std::vector<std::string> compared_dirs;  ///< --compare: two folders; empty: the page of run_dir
  std::string film;                        ///< --film: of both, for the page of --compare
  std::string out_path;                    ///< path of the page, after run()

  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void compare();
  void warnOfOrigin(const std::string& file);
  SnapshotSensorParams sensorParams();
  std::string truthFile() const;
  void writePage(const std::string& path, const std::function<void(const TextSink&)>& write);
  ReportSources sourcesOf(const RunRecord& record);
};

}  // namespace perception
