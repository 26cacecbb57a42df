#include "libperception/calibration/TemperingStudy.h"

#include <fmt/format.h>
#include <nlopt.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "libperception/core/Error.h"
#include "libperception/evaluation/metrics/Metrics.h"

namespace perception {
namespace {

constexpr double kLeastExponent = 0.01, kMostExponent = 1;
constexpr int kEvaluationsARound = 20;      // of the optimizer, each a run over all logs of a part
constexpr double kLeastProbability = 1e-5;  // of the true class: as the filter's own floor

/// Adds classes with reported = false to the truth: labels of poles are the reason for tempering.
GroundTruth withThings(GroundTruth truth, const ClassTable& classes) {
  for (auto& instant : truth.instants) {
    for (TruthObject& o : instant.objects) {
      for (const ObjectClass& c : classes.classes) {
        if (c.reported || o.type != c.kitti_type) continue;
        o.type = c.name;
        o.ignore = false;
      }
    }
  }
  return truth;
}

/// Sums over matched outputs.
struct ClassSums {
  double log_likelihood = 0;
  std::size_t samples = 0, correct = 0, wrong = 0;
};

/// The run's posterior at an evaluated instant: by time, as the evaluation keeps no scene.
const SceneObject* outputOf(const TrackedRun& run, double t, std::uint64_t id) {
  const auto scene = std::lower_bound(
      run.scenes.begin(), run.scenes.end(), t - 1e-6,
      [&](const Scene& s, double time) { return s.stamp - run.first_stamp < time; });
  if (scene == run.scenes.end()) return nullptr;
  for (const SceneObject& o : scene->objects)
    if (o.id == id) return &o;
  return nullptr;
}

ClassSums sumsOf(const TrackedRun& run, const Evaluation& evaluation) {
  ClassSums sums;
  for (const TruthSample& s : evaluation.samples) {
    const auto& match = s.matched(Pairing::kOneToOne);
    const SceneObject* o = match ? outputOf(run, s.t, match->id) : nullptr;
    if (!o) continue;
    const double p = o->class_probability[static_cast<std::size_t>(s.class_id)];
    sums.log_likelihood += std::log(std::max(p, kLeastProbability));
    ++sums.samples;
    sums.correct += match->classified && match->class_id == s.class_id;
    sums.wrong += match->classified && match->class_id != s.class_id;
  }
  return sums;
}

std::vector<double> asVector(const Exponents& e) {
  std::vector<double> x{std::log(e.kinematic)};
  for (const auto& s : e.sensors) x.push_back(std::log(s.label));
  return x;
}
Exponents fromVector(const double* x, Exponents e) {
  e.kinematic = std::exp(x[0]);
  for (std::size_t i = 0; i < e.sensors.size(); ++i) e.sensors[i].label = std::exp(x[i + 1]);
  return e;
}

struct Problem {
  const std::vector<const TemperingLog*>& logs;
  const Exponents& start;
  const TemperingParams& params;
};

double objective(unsigned, const double* x, double*, void* data) {
  const auto& p = *static_cast<const Problem*>(data);
  return calibrate(p.logs, fromVector(x, p.start), p.params).log_likelihood;
}

/// Label exponents and the kinematic one of maximum likelihood (NLopt's Nelder-Mead), from the best
/// of the INI's and of equal ones: the likelihood has ridges, as associations change with it.
Exponents fit(const std::vector<const TemperingLog*>& logs, const Exponents& start,
              const TemperingParams& params) {
  Problem problem{logs, start, params};
  std::vector<double> x = asVector(start);
  for (double& v : x) v = std::clamp(v, std::log(kLeastExponent), std::log(kMostExponent));
  double start_value = objective(0, x.data(), nullptr, &problem);
  for (const double equal : {0.1, 0.3, 1.0}) {
    const std::vector<double> other(x.size(), std::log(equal));
    const double value = objective(0, other.data(), nullptr, &problem);
    if (value > start_value) x = other, start_value = value;
  }
  const auto n = static_cast<unsigned>(x.size());
  nlopt_opt optimizer = nlopt_create(NLOPT_LN_NELDERMEAD, n);
  nlopt_set_lower_bounds1(optimizer, std::log(kLeastExponent));
  nlopt_set_upper_bounds1(optimizer, std::log(kMostExponent));
  nlopt_set_initial_step1(optimizer, -0.7);
  nlopt_set_max_objective(optimizer, objective, &problem);
  nlopt_set_maxeval(optimizer, params.rounds * kEvaluationsARound);
  nlopt_set_xtol_rel(optimizer, 0.01);
  double best = 0;
  nlopt_optimize(optimizer, x.data(), &best);
  nlopt_destroy(optimizer);
  return fromVector(x.data(), start);
}

Exponents meanOf(const Exponents& a, const Exponents& b) {
  const std::vector<double> u = asVector(a), v = asVector(b);
  std::vector<double> x;
  for (std::size_t i = 0; i < u.size(); ++i) x.push_back(0.5 * (u[i] + v[i]));
  return fromVector(x.data(), a);
}

std::vector<std::string> rowOf(const std::string& part, const std::string& what,
                               const ClassCalibration& c) {
  return {part,
          what,
          fmt::format("{:.3f}", c.log_likelihood),
          fmt::format("{:.3f}", c.ece),
          fmt::format("{:.3f}", c.correct),
          fmt::format("{:.3f}", c.wrong),
          fmt::format("{}", c.samples)};
}

/// Mean of both parts, by samples.
ClassCalibration pooledOf(const ClassCalibration& a, const ClassCalibration& b) {
  ClassCalibration out;
  out.samples = a.samples + b.samples;
  const double n = static_cast<double>(std::max<std::size_t>(out.samples, 1));
  const auto mean = [&](double ClassCalibration::*m) {
    return (static_cast<double>(a.samples) * a.*m + static_cast<double>(b.samples) * b.*m) / n;
  };
  out.log_likelihood = mean(&ClassCalibration::log_likelihood);
  out.ece = mean(&ClassCalibration::ece);
  out.correct = mean(&ClassCalibration::correct);
  out.wrong = mean(&ClassCalibration::wrong);
  return out;
}

std::string iniOf(const Exponents& e) {
  std::string text = fmt::format("[filter] kinematic_exponent = {:.3f}", e.kinematic);
  for (const auto& s : e.sensors)
    text += fmt::format("; [sensor.{}] label_exponent = {:.3f}", s.sensor, s.label);
  return text;
}

}  // namespace

ClassCalibration calibrate(const std::vector<const TemperingLog*>& logs, const Exponents& exponents,
                           const TemperingParams& params) {
  std::vector<Evaluation> evaluations(logs.size());
  std::vector<ClassSums> sums(logs.size());
  tbb::parallel_for(
      std::size_t{0}, logs.size(),
      [&](std::size_t i) {
        const TrackedRun run = replay(withExponents(logs[i]->log, exponents),
                                      {params.proposal, params.particles, params.seed});
        evaluations[i] = evaluate(run, logs[i]->truth, params.evaluation);
        sums[i] = sumsOf(run, evaluations[i]);
      },
      tbb::simple_partitioner());
  std::vector<const Evaluation*> parts;
  ClassSums all;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    parts.push_back(&evaluations[i]);
    all.log_likelihood += sums[i].log_likelihood;
    all.samples += sums[i].samples;
    all.correct += sums[i].correct;
    all.wrong += sums[i].wrong;
  }
  if (all.samples == 0) throw DataError("no object of the truth was tracked: nothing to fit on");
  const double n = static_cast<double>(all.samples);
  return {all.log_likelihood / n,
          reliability(pooled(parts), Pairing::kOneToOne).calibration_error.value_or(0),
          static_cast<double>(all.correct) / n, static_cast<double>(all.wrong) / n, all.samples};
}

namespace {

/// Those of independent evidence.
Exponents exactExponents(Exponents e) {
  e.kinematic = 1;
  for (auto& s : e.sensors) s.label = 1;
  return e;
}

}  // namespace

StudyReport temperingStudy(const TemperingParams& params, const std::vector<TemperingLog>& given) {
  if (given.size() < 2) throw DataError("two logs are needed: one to fit on, one to score on");
  std::vector<TemperingLog> logs = given;
  std::vector<const TemperingLog*> parts[2];
  StudyReport report;
  bool simulated = true;
  std::string names;
  for (std::size_t i = 0; i < logs.size(); ++i) {
    logs[i].truth = withThings(std::move(logs[i].truth), logs[i].log.model.classes);
    parts[i % 2].push_back(&logs[i]);
    simulated = simulated && logs[i].log.simulated;
    names += (i ? ", " : "") + logs[i].log.name;
  }
  report.title = "How far labels and innovations count in the class update";
  report.data = fmt::format("{}logs {}", simulated ? "simulated " : "", names);

  const Exponents start = exponentsOf(logs[0].log), ones = exactExponents(start);
  StudyTable table{"tempering",
                   "Class posterior on the logs that the exponents were not fitted on",
                   {"part", "exponents", "mean log P(true class)", "ECE", "correct", "wrong",
                    "objects x instants"},
                   {}};
  StudyTable found{"exponents", "Exponents of maximum likelihood", {"fitted on", "kinematic"}, {}};
  for (const auto& s : start.sensors) found.columns.push_back(s.sensor + " label");
  const auto addFound = [&](const std::string& part, const Exponents& e) {
    found.rows.push_back({part, fmt::format("{:.3f}", e.kinematic)});
    for (const auto& s : e.sensors) found.rows.back().push_back(fmt::format("{:.3f}", s.label));
  };
  addFound("the INI", start);
  const char* const part_names[2] = {"odd logs", "even logs"};
  Exponents best[2];
  ClassCalibration scores[3][2];
  for (std::size_t k = 0; k < 2; ++k) {
    best[k] = fit(parts[k], start, params);
    addFound(part_names[k], best[k]);
    const auto& test = parts[1 - k];
    scores[0][k] = calibrate(test, ones, params);
    scores[1][k] = calibrate(test, start, params);
    scores[2][k] = calibrate(test, best[k], params);
  }
  const char* const what[3] = {"1 (exact for independent evidence)", "the INI's", "fitted"};
  for (std::size_t w = 0; w < 3; ++w) {
    for (std::size_t k = 0; k < 2; ++k)
      table.rows.push_back(rowOf(part_names[1 - k], what[w], scores[w][k]));
    table.rows.push_back(rowOf("all", what[w], pooledOf(scores[w][0], scores[w][1])));
  }
  const Exponents mean = meanOf(best[0], best[1]);
  addFound("both: geometric mean", mean);
  report.tables = {table, found};
  report.remarks = {
      "For the INI: " + iniOf(mean) + ".",
      "Truth counts as in the evaluation, poles and hedges of simulated logs included; an object "
      "counts at every instant at which it is tracked.",
      "correct, wrong: shares with a class of probability .95 or more that is the true one or not.",
      "What no label tells is fitted with it: other front ends, classes or rates want a fit of "
      "their own."};
  return report;
}

}  // namespace perception
