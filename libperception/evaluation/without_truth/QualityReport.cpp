#include "libperception/evaluation/without_truth/QualityReport.h"

#include <fmt/format.h>

#include <map>

#include "libperception/core/math/Angle.h"
#include "libperception/evaluation/without_truth/QualityPicture.h"

namespace perception {
namespace {

constexpr std::size_t kMoments = 40;  ///< listed

std::string text(const Figure& value) { return value ? fmt::format("{:.3f}", *value) : "n/a"; }

/// Of the same log, and nothing else different but the seed.
bool isSibling(const RunRecord& a, const RunRecord& b) {
  return !a.input.empty() && a.input == b.input && a.config == b.config &&
         a.sensors_used == b.sensors_used && a.seed != b.seed;
}

StudyTable figuresTable(const std::vector<JudgedRun>& runs, bool all) {
  StudyTable table{"quality", "Figures without a truth: larger is worse", {"run", "objects"}, {}};
  for (const QualityKind& kind : qualityKinds())
    if (all || kind.follows_it())
      table.columns.push_back(fmt::format("{} [{}]", kind.name, kind.unit));
  for (const JudgedRun& r : runs) {
    std::vector<std::string> row = {r.name, std::to_string(r.quality.objects)};
    for (std::size_t k = 0; k < qualityKinds().size(); ++k)
      if (all || qualityKinds()[k].follows_it()) row.push_back(text(r.quality.values[k]));
    table.rows.push_back(std::move(row));
  }
  return table;
}

StudyTable meaningTable() {
  StudyTable table{
      "meaning",
      "What they are, and their rank correlation with the true error where it is known",
      {"figure", "is", "follows", "between logs", "within a log"},
      {}};
  for (const QualityKind& kind : qualityKinds())
    if (kind.follows_it())
      table.rows.push_back({kind.name, kind.meaning, nameOf(kind.follows),
                            fmt::format("{:.2f}", kind.between_logs),
                            fmt::format("{:.2f}", kind.within_log)});
  return table;
}

StudyTable momentsTable(const JudgedRun& run) {
  StudyTable table{"moments", run.name + ": moments to look at", {"t [s]", "object", "it"}, {}};
  for (const QualityMoment& m : run.quality.moments) {
    if (table.rows.size() == kMoments) break;
    table.rows.push_back({fmt::format("{:.1f}", m.t), std::to_string(m.id), m.text()});
  }
  if (run.quality.moments.size() > kMoments)
    table.title += fmt::format(" (the first {} of {})", kMoments, run.quality.moments.size());
  return table;
}

StudyTable errorsTable(const std::vector<JudgedRun>& runs) {
  StudyTable table{"errors", "True errors", {"run"}, {}};
  for (std::size_t e = 0; e < kTrueErrors; ++e)
    table.columns.emplace_back(nameOf(static_cast<TrueError>(e)));
  for (const JudgedRun& r : runs) {
    if (!r.errors) continue;
    std::vector<std::string> row = {r.name};
    for (const Figure& error : *r.errors) row.push_back(text(error));
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// Over all runs, and within each condition (mean, and the least).
StudyTable correlationTable(const std::vector<JudgedRun>& runs) {
  StudyTable table{
      "correlation",
      "Spearman's rank correlation of each figure with the true error it should follow",
      {"figure", "true error", "runs", "all runs", "within a log, mean", "least"},
      {}};
  for (std::size_t k = 0; k < qualityKinds().size(); ++k) {
    const QualityKind& kind = qualityKinds()[k];
    std::vector<Figure> values, errors;
    std::map<std::string, std::pair<std::vector<Figure>, std::vector<Figure>>> by_log;
    std::size_t both = 0;
    for (const JudgedRun& r : runs) {
      if (!r.errors) continue;
      const Figure error = (*r.errors)[static_cast<std::size_t>(kind.follows)];
      values.push_back(r.quality.values[k]), errors.push_back(error);
      by_log[r.condition].first.push_back(r.quality.values[k]);
      by_log[r.condition].second.push_back(error);
      both += r.quality.values[k] && error;
    }
    double sum = 0, least = 1;
    std::size_t logs = 0;
    for (const auto& [log, pairs] : by_log) {
      const Figure rho = rankCorrelation(pairs.first, pairs.second);
      if (!rho) continue;
      sum += *rho, least = std::min(least, *rho), ++logs;
    }
    table.rows.push_back({kind.name, nameOf(kind.follows), std::to_string(both),
                          text(rankCorrelation(values, errors)),
                          text(logs > 0 ? Figure(sum / static_cast<double>(logs)) : Figure()),
                          text(logs > 0 ? Figure(least) : Figure())});
  }
  return table;
}

}  // namespace

StudyReport qualityReport(std::vector<JudgedRun>& judged, const QualityOptions& options,
                          bool has_truth) {
  bool simulated = false;
  for (JudgedRun& r : judged) {
    std::vector<const TrackedRun*> siblings;
    for (const JudgedRun& other : judged)
      if (other.condition == r.condition && isSibling(r.record, other.record))
        siblings.push_back(&other.run);
    r.quality = qualityOf(r.run, siblings, options);
    simulated = simulated || r.record.simulated;
  }
  StudyReport report;
  report.title = "Quality of runs without a truth";
  report.data = fmt::format("{}{} runs; objects within {:g} m, {:g} deg ahead",
                            simulated ? "simulated (at least one): " : "", judged.size(),
                            options.selection.range, degrees(options.selection.fov));
  report.tables.push_back(figuresTable(judged, has_truth));
  if (!has_truth) report.tables.push_back(meaningTable());
  if (judged.size() == 1) {
    report.tables.push_back(momentsTable(judged.front()));
    report.plots.push_back(momentsPicture(judged.front().run, judged.front().quality, options));
  }
  if (has_truth) {
    report.tables.push_back(errorsTable(judged));
    report.tables.push_back(correlationTable(judged));
    std::vector<FiguresAndErrors> pairs;
    for (const JudgedRun& r : judged)
      if (r.errors) pairs.push_back({r.quality.values, *r.errors});
    report.plots.push_back(followingPicture(pairs));
  }
  report.remarks.push_back(
      "No figure is an error. They compare settings on one log, or logs under one setting: the "
      "rank correlations say how far.");
  return report;
}

}  // namespace perception
