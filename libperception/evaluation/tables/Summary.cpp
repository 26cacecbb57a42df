#include <fmt/format.h>

#include "libperception/evaluation/tables/ReportCells.h"

namespace perception {
namespace {

std::string summaryOf(const EvaluatedRun& run, const EvaluationOptions& options) {
  const Evaluation& e = run.evaluation;
  const TrackingFigures closest = trackingFigures(e, Pairing::kClosest);
  const TrackingFigures single = trackingFigures(e, Pairing::kOneToOne);
  const FalseObjectFigures wrong = falseObjectFigures(e);
  const auto line = [](const char* what, const std::string& figures) {
    return fmt::format("  {:<15}{}\n", what, figures);
  };
  const bool known = closest.active > 0;
  std::string text = fmt::format("{}: {} instants, {} views of true objects that count\n", run.name,
                                 e.instants.size(), closest.active);
  text += line("tracked", fmt::format("{} of the views; {} id switches, {} gaps",
                                      number(closest.tracked_a), countOf(single.id_switches, known),
                                      countOf(single.fragmentations, known)));
  text += line("class", fmt::format("right and sure {}, wrong and sure {}, not sure {}",
                                    number(closest.correct), number(closest.mis),
                                    number(closest.unclassified)));
  text += line("false objects",
               fmt::format("{} an instant, of a sure class {}", number(wrong.per_instant, 2),
                           number(wrong.classified_per_instant, 2)));
  const IdentityFigures identities = identityFigures(e);
  text += line("together",
               fmt::format("MOTA {}, HOTA {}, IDF1 {}, GOSPA {} m", number(clearFigures(e).mota),
                           number(identities.hota), number(identities.idf1),
                           number(setFigures(e, options.cutoff).gospa_mean, 2)));
  text += line("errors (rms)",
               fmt::format("position {} m, velocity {} m/s", number(single.position_rms, 2),
                           number(single.velocity_rms, 2)));
  text +=
      line("headings",
           fmt::format("{} rad (rms), reversed {}; front known (p_front >= {:g}) in {}, of these "
                       "reversed {}, calibration error {}",
                       number(single.heading_rms, 2), number(single.heading_reversed), kSureFront,
                       number(single.heading_sure), number(single.heading_sure_reversed),
                       number(frontReliability(e, Pairing::kOneToOne).calibration_error)));
  return text;
}

}  // namespace

std::string summaryText(const EvaluationReport& report) {
  std::string text;
  for (const EvaluatedRun& run : report.runs) text += summaryOf(run, report.options);
  return text;
}

}  // namespace perception
