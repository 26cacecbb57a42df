#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/evaluation/FrontEndEvaluation.h"
#include "libperception/evaluation/Metrics.h"
#include "libperception/evaluation/PaperTables.h"

namespace perception {

/// One run held against the truth, or several of one condition pooled.
struct EvaluatedRun {
  std::string name;  ///< as it stands in the tables
  std::string dir;
  Evaluation evaluation;
  std::optional<CountDifference> count_difference = {};  ///< against EvaluationReport::reference
  std::vector<FrontEndEvaluation> front_ends = {};       ///< in the order asked for
  std::vector<EvaluatedRun> trials = {};  ///< the runs that were pooled; empty: a single run
};

/// The runs of one condition as one; they stay in `trials`. Throws DataError when they cannot be.
EvaluatedRun pooledRun(std::string name, std::vector<EvaluatedRun> trials);

/// Runs of one condition become one, at the place of the first of them; `conditions` holds that of
/// every run, "": it stays on its own. Throws DataError.
std::vector<EvaluatedRun> pooledByCondition(const std::vector<std::string>& conditions,
                                            std::vector<EvaluatedRun> runs);

/// All that a report tells.
struct EvaluationReport {
  std::string command;    ///< the command line with every option that a figure depends on
  std::string truth;      ///< path of the truth
  std::string reference;  ///< path of the run that object counts are compared with; may be empty
  EvaluationOptions options;
  std::vector<EvaluatedRun> runs;
  std::vector<PaperTrackingRow> paper;  ///< rows of [radecki2016] beside the runs
  std::vector<std::string> plots;       ///< file names beside the report, for Markdown
};

/// A table of a report; the first `labels` columns are words, the others numbers.
struct ReportTable {
  std::string title;
  std::vector<std::string> notes;  ///< definitions, one line each
  std::vector<std::string> header;
  std::size_t labels = 1;
  std::vector<std::vector<std::string>> rows;
};

/// The tables of the report; the one with the columns of [radecki2016], in its order, comes first.
std::vector<ReportTable> reportTables(const EvaluationReport& report);

/// Tables of the front ends, beside those of [radecki2016]; none where no front end was asked for.
std::vector<ReportTable> frontEndTables(const EvaluationReport& report);
/// Every figure a row, every run a column; conditions with mean, deviation and range over trials.
ReportTable sideBySideTable(const EvaluationReport& report);

std::string textReport(const EvaluationReport& report);
std::string markdownReport(const EvaluationReport& report);
/// A line an instant: frame,t,truth,estimates,gospa,localization,missed,false,ospa,outputs,
/// false_outputs; [m], its parts [m^2].
std::string instantsCsv(const EvaluatedRun& run);
/// Every figure of the tables, both pairings, by run; null where a table says n/a.
std::string jsonReport(const EvaluationReport& report);

}  // namespace perception
