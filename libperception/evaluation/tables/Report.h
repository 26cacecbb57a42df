#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/front_ends/FrontEndEvaluation.h"
#include "libperception/evaluation/metrics/Metrics.h"
#include "libperception/evaluation/metrics/TrackingBenchmark.h"
#include "libperception/evaluation/tables/PaperTables.h"

namespace perception {

/// Evaluation of one run, or of the pooled runs of one condition.
struct EvaluatedRun {
  std::string name;  ///< in the tables
  std::string dir;
  Evaluation evaluation;
  std::optional<CountDifference> count_difference = {};  ///< against EvaluationReport::reference
  std::vector<FrontEndEvaluation> front_ends = {};       ///< in the order of --front-end
  std::vector<BenchmarkFigures> benchmark = {};          ///< with --nuscenes, by class
  std::vector<EvaluatedRun> trials = {};  ///< the pooled runs; empty for a single run
  /// Of a simulated log ("" in clear air); unknown of recordings and of pooled runs.
  std::optional<std::string> weather = {};
  std::string id = {};  ///< of the run, as its products carry it; empty: it did not finish
};

/// Pools the runs of one condition; they are kept in `trials`. Throws DataError when their classes
/// differ.
EvaluatedRun pooledRun(std::string name, std::vector<EvaluatedRun> trials);

/// Pools the runs of each condition at the place of its first run. `conditions`: condition of each
/// run; "": not pooled. Throws DataError.
std::vector<EvaluatedRun> pooledByCondition(const std::vector<std::string>& conditions,
                                            std::vector<EvaluatedRun> runs);

/// Contents of a report.
struct EvaluationReport {
  std::string command;    ///< command line with every option that affects the results
  std::string truth;      ///< path of the truth
  std::string reference;  ///< path of the reference run of the object counts; may be empty
  EvaluationOptions options;
  std::vector<EvaluatedRun> runs;
  std::vector<PaperTrackingRow> paper;  ///< rows of [radecki2016] to list for comparison
  std::vector<std::string> plots;       ///< paths relative to the report, for Markdown
};

/// Whether some run of the report may be of a weather for which `has` holds; runs of unknown
/// weather may be. A row of [radecki2016] of another weather must not stand beside the runs.
bool anyRunOfWeather(const EvaluationReport& report,
                     const std::function<bool(const std::string& weather)>& has);
/// Removes the rows of [radecki2016] of weathers that no run is of; returns the tables' names.
std::vector<std::string> dropRowsOfOtherWeathers(EvaluationReport& report);

/// A table of a report; the first `labels` columns are text, the others numbers.
struct ReportTable {
  std::string title;
  std::vector<std::string> notes;  ///< definitions, one line each
  std::vector<std::string> header;
  std::size_t labels = 1;
  std::vector<std::vector<std::string>> rows;
};

/// The tables of the report, first the one with the columns of [radecki2016].
std::vector<ReportTable> reportTables(const EvaluationReport& report);

/// Tables of the front ends with the values of [radecki2016]; empty without --front-end.
std::vector<ReportTable> frontEndTables(const EvaluationReport& report);
/// One row per metric, one column per run; conditions with mean, standard deviation and range over
/// trials.
ReportTable sideBySideTable(const EvaluationReport& report);

/// The figures that decide, seven lines a run: of all classes, false objects and headings included.
std::string summaryText(const EvaluationReport& report);
std::string textReport(const EvaluationReport& report);
std::string markdownReport(const EvaluationReport& report);
/// One line per instant: frame,t,truth,estimates,gospa,localization,missed,false,ospa,outputs,
/// false_outputs; [m], its parts [m^2].
std::string instantsCsv(const EvaluatedRun& run);
/// Every metric of the tables, both pairings, by run; null for n/a.
std::string jsonReport(const EvaluationReport& report);

}  // namespace perception
