#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "libperception/evaluation/tables/ReportCells.h"
#include "libperception/scene/files/NumberFormat.h"

namespace perception {
namespace {

constexpr std::size_t kListed = 10;

/// What a reader of the output is misled by at one instant.
struct Misled {
  std::size_t instant = 0, faults = 0;
  std::vector<std::string> missed, wrong, invented;
};

std::string listOf(const std::vector<std::string>& items) {
  return items.empty() ? "-" : fmt::format("{}", fmt::join(items, ", "));
}

std::vector<Misled> misledInstants(const Evaluation& evaluation) {
  std::vector<Misled> all(evaluation.instants.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    all[i].instant = i;
    for (const FalseObject& o : evaluation.instants[i].false_objects)
      if (o.classified)
        all[i].invented.push_back(fmt::format("{} {}", className(evaluation, o.class_id), o.id));
  }
  for (const TruthSample& sample : evaluation.samples) {
    Misled& at = all[sample.instant];
    const auto& match = sample.matched(Pairing::kOneToOne);
    const std::string name = fmt::format("{} {}", sample.type, sample.id);
    if (!match) {
      at.missed.push_back(name);
    } else if (match->classified && match->class_id != sample.class_id) {
      at.wrong.push_back(fmt::format("{} as {}", name, className(evaluation, match->class_id)));
    }
  }
  for (Misled& at : all) at.faults = at.missed.size() + at.wrong.size() + at.invented.size();
  return all;
}

}  // namespace

ReportTable worstInstantsTable(const EvaluatedRun& run) {
  ReportTable table = makeTable("Worst instants: " + run.name, {"Missed", "Wrong", "False"},
                                {"time (s)", "frame", "GOSPA (m)"});
  table.notes = {
      fmt::format("At most {}, by the number of missed and wrong truth objects (one-to-one "
                  "matching) and sure false outputs, then by GOSPA. Ids: of the truth, of false "
                  "ones those of the run.",
                  kListed),
      "To look at one: perception-snapshot --frame or --time."};
  const auto& instants = run.evaluation.instants;
  std::vector<Misled> all = misledInstants(run.evaluation);
  all.erase(std::remove_if(all.begin(), all.end(), [](const Misled& m) { return m.faults == 0; }),
            all.end());
  std::stable_sort(all.begin(), all.end(), [&](const Misled& a, const Misled& b) {
    if (a.faults != b.faults) return a.faults > b.faults;
    return instants[a.instant].gospa.value() > instants[b.instant].gospa.value();
  });
  all.resize(std::min(all.size(), kListed));
  for (const Misled& at : all) {
    const InstantFigures& instant = instants[at.instant];
    table.rows.push_back({listOf(at.missed), listOf(at.wrong), listOf(at.invented),
                          fixedPlaces(instant.t, 2), fmt::format("{}", instant.frame),
                          fixedPlaces(instant.gospa.value(), 3)});
  }
  return table;
}

}  // namespace perception
