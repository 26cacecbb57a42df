#include <fmt/format.h>

#include "libperception/evaluation/tables/ReportCells.h"

namespace perception {

const char* nameOf(TruthMotion motion) {
  switch (motion) {
    case TruthMotion::kStanding:
      return "standing";
    case TruthMotion::kMoving:
      return "moving";
    default:
      return "any";
  }
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
    const Evaluation& e = run.evaluation;
    for (ClassId c = -1; c < static_cast<ClassId>(e.class_names.size()); ++c) {
      for (const TruthMotion motion : kAllMotions) {
        const FrontFigures f = frontFigures(e, Pairing::kOneToOne, c, motion);
        if (f.headings == 0) continue;
        table.rows.push_back({run.name, className(e, c), nameOf(motion),
                              fmt::format("{}", f.matched), number(f.with_heading),
                              number(f.front_known), number(f.known_reversed),
                              number(f.other_reversed), number(f.calibration_error)});
      }
    }
  }
  return table;
}

}  // namespace perception
