#include <fmt/format.h>

#include <utility>
#include <vector>

#include "libperception/evaluation/tables/ReportCells.h"

namespace perception {

std::vector<FrontRow> frontRows(const Evaluation& evaluation) {
  constexpr std::pair<const char*, TruthMotion> kMotions[] = {{"any", TruthMotion::kAny},
                                                              {"standing", TruthMotion::kStanding},
                                                              {"moving", TruthMotion::kMoving}};
  std::vector<FrontRow> rows;
  for (ClassId c = -1; c < static_cast<ClassId>(evaluation.class_names.size()); ++c) {
    for (const auto& [name, motion] : kMotions) {
      FrontRow row{c, name, frontFigures(evaluation, Pairing::kOneToOne, c, motion)};
      if (row.figures.headings > 0) rows.push_back(std::move(row));
    }
  }
  return rows;
}

ReportTable frontTable(const EvaluationReport& report) {
  ReportTable table = makeTable("Fronts of objects", {"Run", "Class", "Motion"},
                                {"matched", "with heading", "front known", "known, reversed",
                                 "others, reversed", "calibration error"});
  table.notes = {
      fmt::format("One-to-one matching. with heading, front known: shares of the matched; known: "
                  "p_front of at least {:g}.",
                  kSureFront),
      "reversed: share more than 90 deg off, of those whose front is known and of the others that "
      "have a heading.",
      "calibration error: mean |stated p_front - share that is not reversed| over ten bins, "
      "weighted by instants.",
      fmt::format("standing: slower than {:g} m/s in the truth; a truth without velocity is in "
                  "neither.",
                  kStandingSpeed)};
  for (const EvaluatedRun& run : report.runs) {
    for (const auto& [class_id, motion, f] : frontRows(run.evaluation)) {
      table.rows.push_back({run.name, className(run.evaluation, class_id), motion,
                            fmt::format("{}", f.matched), number(f.with_heading),
                            number(f.front_known), number(f.known_reversed),
                            number(f.other_reversed), number(f.calibration_error)});
    }
  }
  return table;
}

}  // namespace perception
