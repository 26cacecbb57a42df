#include "libperception/calibration/clusters/ClusterStudy.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/calibration/clusters/ShapeExamples.h"
#include "libperception/core/Error.h"

namespace perception {
namespace {

using Shares = std::array<double, kShapes>;  ///< probabilities of the kinds that are not mixed

constexpr double kSure = 0.95;

Shares sharesOf(const ClusterClassifier& classifier, const Descriptor& d) {
  const auto p = classifier.probabilities(d);
  Shares q{};
  double sum = 0;
  for (std::size_t k = 0; k < kShapes; ++k) sum += q[k] = p[k];
  for (double& v : q) v /= sum;
  return q;
}

std::size_t likeliest(const Shares& q) {
  return static_cast<std::size_t>(std::max_element(q.begin(), q.end()) - q.begin());
}

/// Counts over the whole clusters of a log whose kind is known.
struct Counts {
  double loss = 0;
  std::array<double, kShapes> of{}, right{}, called{};
  double n = 0, sure = 0, sure_wrong = 0, sure_users = 0, sure_users_wrong = 0;
  struct Bin {
    double n = 0, sum = 0, right = 0;
  };
  std::array<Bin, 10> bins{};  ///< by the probability of the likeliest kind

  void add(const Shares& q, std::size_t kind) {
    const std::size_t best = likeliest(q);
    const bool is_right = best == kind;
    n += 1, loss -= std::log(q[kind]);
    of[kind] += 1, called[best] += 1, right[kind] += is_right;
    if (q[best] >= kSure) {
      sure += 1, sure_wrong += !is_right;
      if (best < kRoadUsers) sure_users += 1, sure_users_wrong += !is_right;
    }
    for (std::size_t k = 0; k < kShapes; ++k) {
      Bin& bin = bins[std::min<std::size_t>(9, static_cast<std::size_t>(q[k] * 10))];
      bin.n += 1, bin.sum += q[k], bin.right += k == kind;
    }
  }
  /// Log loss of one who knows the log's own shares of the kinds and nothing else.
  double priorLoss() const {
    double sum = 0;
    for (const double k : of) {
      const double share = (k + 0.5) / (n + 0.5 * kShapes);
      sum -= k / n * std::log(share);
    }
    return sum;
  }
};

std::string ratio(double a, double b) { return b > 0 ? fmt::format("{:.2f}", a / b) : ""; }

std::vector<std::string> leftOutRow(const std::string& name, const Counts& counts) {
  std::vector<std::string> row = {
      name,
      fmt::format("{:.0f}", counts.n),
      fmt::format("{:.3f}", counts.loss / counts.n),
      fmt::format("{:.3f}", counts.priorLoss()),
      ratio(counts.sure, counts.n),
      fmt::format("{:.4f}", counts.sure_wrong / std::max(1.0, counts.sure)),
      fmt::format("{:.0f}", counts.sure_users),
      fmt::format("{:.0f}", counts.sure_users_wrong)};
  for (std::size_t k = 0; k < kShapes; ++k) {
    row.push_back(fmt::format("{:.0f}", counts.of[k]));
    row.push_back(ratio(counts.right[k], counts.of[k]));
    row.push_back(ratio(counts.right[k], counts.called[k]));
  }
  return row;
}

void addReliability(const std::string& name, const Counts& counts, StudyTable& reliability) {
  for (std::size_t b = 0; b < counts.bins.size(); ++b) {
    const Counts::Bin& bin = counts.bins[b];
    if (bin.n > 0)
      reliability.rows.push_back({name, fmt::format("{:.1f}", 0.1 * static_cast<double>(b)),
                                  fmt::format("{:.3f}", bin.sum / bin.n),
                                  fmt::format("{:.3f}", bin.right / bin.n),
                                  fmt::format("{:.0f}", bin.n)});
  }
}

/// True objects of a log and how many of them have a cluster of their kind; `shares`: of all
/// samples.
std::vector<std::string> boxRow(const std::string& name, const ClusterSamples& samples,
                                std::size_t log, const std::vector<Shares>& shares) {
  std::array<double, 3> objects{}, right{};
  for (const ObjectView& o : samples.objects) {
    if (o.log != log || o.returns < 20 || o.range > 40) continue;
    const auto k = static_cast<std::size_t>(o.kind);
    objects[k] += 1;
    right[k] += o.sample >= 0 && likeliest(shares[static_cast<std::size_t>(o.sample)]) == k;
  }
  std::vector<std::string> box_row = {name};
  for (std::size_t k = 0; k < 3; ++k) {
    box_row.push_back(fmt::format("{:.0f}", objects[k]));
    box_row.push_back(ratio(right[k], objects[k]));
  }
  return box_row;
}

StudyPlot reliabilityPlot(const StudyTable& reliability) {
  std::string points;
  for (const auto& row : reliability.rows)
    points += fmt::format("{} {} {}\n", row[2], row[3], row[4]);
  StudyPlot plot;
  plot.name = "reliability";
  plot.caption =
      "Stated probabilities of all kinds against what came true, a point a log and tenth; "
      "its area grows with the number of clusters";
  plot.script =
      "set xlabel 'stated probability'; set ylabel 'share that came true'; set size square\n"
      "set xrange [0:1]; set yrange [0:1]; set key off\n"
      "plot x with lines lc rgb 'gray', 'reliability.dat' using 1:2:(0.004*log($3+1)) with circles "
      "lc rgb '#2060a0' fs transparent solid 0.5\n";
  plot.data.emplace_back("reliability.dat", points);
  return plot;
}

// Each log is judged by what the others teach.
void requireThreeLogs(const ClusterSamples& samples, std::size_t logs) {
  std::set<std::size_t> known;
  for (const ClusterSample& s : samples.clusters)
    if (s.kind) known.insert(s.log);
  if (known.size() < 3)
    throw DataError(
        fmt::format("{} of {} logs have clusters of lidar returns whose kind the truth tells; "
                    "expected three or "
                    "more, since each is judged by what the others teach",
                    known.size(), logs));
}

/// Judges each log by what the others teach: the report's tables and plot.
void judgeLeftOut(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                  const Provenance& provenance, ClusterTrainer& trainer, StudyReport& report) {
  StudyTable left_out{"left_out",
                      "Clusters of each log by a classifier that has not seen it",
                      {"log", "clusters", "log loss", "of the log's shares", "sure", "sure wrong",
                       "sure road users", "of them wrong"},
                      {}};
  for (std::size_t k = 0; k < kShapes; ++k)
    for (const char* what : {"", " recall", " precision"})
      left_out.columns.push_back(std::string(kClusterKindNames[k]) + what);
  StudyTable boxes{"boxes",
                   "True objects (20 returns or more, within 40 m) whose cluster is told right",
                   {"log", "pedestrians", "right", "cyclists", "right", "vehicles", "right"},
                   {}};
  StudyTable reliability{"reliability",
                         "Probabilities of all kinds against what came true",
                         {"log", "stated", "mean", "true", "number"},
                         {}};
  std::vector<Shares> all(samples.clusters.size());
  for (std::size_t log = 0; log < logs.size(); ++log) {
    if (!provenance.simulated_only && logs[log].simulated) continue;
    const ClusterClassifier blind = trainer.classifier(log, provenance);
    for (const std::size_t i : trainer.of(log))
      all[i] = sharesOf(blind, samples.clusters[i].descriptor);
    Counts counts;
    for (const std::size_t i : trainer.of(log)) {
      const ClusterSample& s = samples.clusters[i];
      if (s.kind && *s.kind != ClusterKind::kMixed && s.whole < 0)
        counts.add(all[i], static_cast<std::size_t>(*s.kind));
    }
    if (counts.n == 0) continue;
    const std::string& name = logs[log].name;
    left_out.rows.push_back(leftOutRow(name, counts));
    addReliability(name, counts, reliability);
    boxes.rows.push_back(boxRow(name, samples, log, all));
  }
  report.tables = {std::move(left_out), std::move(boxes)};
  report.plots.push_back(reliabilityPlot(reliability));
  report.tables.push_back(std::move(reliability));
}

void addKnown(const KnownShapes& known, StudyReport& report) {
  StudyTable table{"known",
                   "Shapes that are known: examples, and the distance from them up to which a "
                   "cluster counts as known",
                   {"kind", "examples", "within"},
                   {}};
  for (std::size_t k = 0; k < kRoadUsers; ++k)
    if (known.of(k).within > 0)
      table.rows.push_back({kClusterKindNames[k], fmt::format("{}", known.of(k).examples.size()),
                            fmt::format("{:.3f}", known.of(k).within)});
  report.tables.push_back(std::move(table));
}

void addModel(const ClusterClassifier& model, StudyReport& report) {
  addKnown(model.known(), report);
  report.remarks.push_back(
      "`lidar_classes.json` is the model for `[sensor.LABEL.classifier] file`.");
  report.files.emplace_back("lidar_classes.json", model.write());
}

std::string namesOf(const std::vector<TrainingLog>& logs) {
  std::string names;
  for (const TrainingLog& log : logs)
    names += fmt::format("{}{}{}", names.empty() ? "" : ", ", log.name,
                         log.simulated ? " (simulated)" : "");
  return names;
}

}  // namespace

StudyReport knownShapesStudy(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                             const ClusterClassifier& model) {
  const auto& learned = model.provenance().data;
  for (const TrainingLog& log : logs)
    if (!log.simulated && std::find(learned.begin(), learned.end(), log.name) == learned.end())
      throw DataError(fmt::format("{}: the model has not learned from this log, expected one of {}",
                                  log.name, fmt::join(learned, ", ")));
  StudyReport report;
  report.title = "What clusters of lidar returns look like: known shapes";
  report.data = namesOf(logs);
  addModel(ClusterClassifier(model.trees(), model.calibrations(), model.prior(), model.memory(),
                             model.provenance(), shapeExamples(samples, logs, logs.size())),
           report);
  return report;
}

StudyReport clusterStudy(const ClusterSamples& samples, const std::vector<TrainingLog>& logs,
                         const Provenance& provenance, std::uint64_t seed, bool model_only) {
  requireThreeLogs(samples, logs.size());
  ClusterTrainer trainer(samples, logs, seed);
  StudyReport report;
  report.title = "What clusters of lidar returns look like";
  const bool simulated = std::any_of(logs.begin(), logs.end(), [](auto& l) { return l.simulated; });
  report.data = namesOf(logs);
  if (simulated && provenance.simulated_only) report.data = "simulated logs " + report.data;

  if (!model_only) judgeLeftOut(samples, logs, provenance, trainer, report);
  const ClusterClassifier final = trainer.classifier(logs.size(), provenance);
  const EvidenceMemory& memory = final.memory();
  report.remarks.push_back(
      fmt::format("Of the variance of the errors of one object's evidence a share of {:.2f} stays; "
                  "the rest has a "
                  "correlation of {:.2f} in views alike, which falls to 1/e by a change of bearing "
                  "of {:.1f} rad, "
                  "of the log of the range of {:.1f}, or within {:.1f} s.",
                  memory.lasting, memory.kept, memory.bearing, memory.log_range, memory.time));
  addModel(final, report);
  return report;
}

}  // namespace perception
