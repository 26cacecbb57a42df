#pragma once
#include <string>
#include <vector>

#include "libperception/evaluation/tables/Report.h"

namespace perception {

using Row = std::vector<std::string>;

inline constexpr const char* kNotAvailable = "n/a";
inline constexpr Pairing kAllPairings[] = {Pairing::kClosest, Pairing::kOneToOne};

/// A table without rows: header of text columns, then of number columns.
ReportTable makeTable(std::string title, Row labels, const Row& numbers);

/// With this many decimal places, or n/a.
std::string number(const Figure& figure, int places = 3);
/// A count; n/a unless `known` (there is truth).
std::string countOf(std::size_t count, bool known);
const char* nameOf(Pairing pairing);
/// "all" for -1.
std::string className(const Evaluation& evaluation, ClassId c);

/// What is known of the fronts of one class (-1: all), so far as its objects move so.
struct FrontRow {
  ClassId class_id;
  const char* motion;  ///< any, standing or moving
  FrontFigures figures;
};
/// By class and motion; rows where something has a heading.
std::vector<FrontRow> frontRows(const Evaluation& evaluation);
/// The rows of each run.
ReportTable frontTable(const EvaluationReport& report);

// Tables of one run.
ReportTable confusionTable(const EvaluatedRun& run, Pairing pairing);
ReportTable reliabilityTable(const EvaluatedRun& run);
ReportTable existenceTable(const EvaluatedRun& run);
ReportTable objectTable(const EvaluatedRun& run);
/// The instants with the most missed, wrong and falsely output objects; no rows: there are none.
ReportTable worstInstantsTable(const EvaluatedRun& run);

}  // namespace perception
