#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "gui-offscreen/html/ReportPage.h"
#include "libperception/app/App.h"
#include "libperception/app/show/ReportData.h"
#include "libperception/core/system/SpoolFile.h"
#include "libperception/pictures/SnapshotSensors.h"
#include "libperception/scene/files/RunRecord.h"

namespace perception {

/// perception-report: HTML page of a run, from the results of the other programs in its folder, or
/// of what differs between two runs.
class ReportApp : public App {
 public:
  std::string run_dir;         ///< -r: folder of perception-track
  std::string evaluation_dir;  ///< --evaluation; empty: evaluation/ of the run, when it is there
  std::string truth_file;      ///< -t; empty: LOG.truth.csv beside the log, when it is there
  std::vector<std::string> compared_dirs;  ///< --compare: two folders; empty: the page of run_dir
  std::string film;                        ///< --film: of both, for the page of --compare
  std::string out_path;                    ///< path of the page, after run()

  std::string name() const override { return "perception-report"; }
  std::string description() const override;
  void declare(CLI::App& cli) override;
  void run() override;

 private:
  void compare();
  /// Those of the run among `rows` of names.
  template <class Rows>
  std::vector<ReportContent::Figure> figuresIn(const std::filesystem::path& dir, const Rows& rows,
                                               const std::string& id);
  void warnOfOrigin(const std::filesystem::path& file);
  void addOtherPictures(ReportContent& content) const;
  void addEvaluation(ReportContent& content);
  SnapshotSensorParams sensorParams();
  std::string truthFile() const;
  void writePage(const std::string& path, const std::function<void(const TextSink&)>& write);
  ReportSources sourcesOf(const RunRecord& record);
};

}  // namespace perception
