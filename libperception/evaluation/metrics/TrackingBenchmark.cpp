#include "libperception/evaluation/metrics/TrackingBenchmark.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "libperception/core/math/Assignment.h"

namespace perception {
namespace {

// By the benchmark's definition.
constexpr double kBenchmarkMatch = 2;  // [m]
constexpr std::size_t kRecalls = 40;
constexpr double kLeastRecall = 0.1;
constexpr double kFarClass = 50, kNearClass = 40;  // [m]

// [m] between the mean lengths of nuScenes' buses (11) and trucks (7).
constexpr double kBusLength = 9;

// Counts of CLEAR MOT.
struct Clear {
  std::size_t truth = 0, matched = 0, switches = 0, false_boxes = 0;
  double error = 0;                  // [m] sum over the matched
  std::vector<double> match_scores;  // of the matched tracks

  double recall() const { return static_cast<double>(matched) / static_cast<double>(truth); }
  double motar() const {
    if (matched == 0) return 0;
    const double P = static_cast<double>(truth), r = recall();
    const double faults =
        static_cast<double>(switches + false_boxes + (truth - matched)) - (1 - r) * P;
    return std::max(0.0, 1 - faults / (r * P));
  }
};

using TrackOf = std::map<std::int64_t, std::int64_t>;  // track by object of the truth

double distanceOf(const BenchmarkBox& a, const BenchmarkBox& b) {
  return (a.center - b.center).norm();
}

// Track of each truth of a frame, -1 without; `before`: the last ones.
std::vector<int> matchFrame(const std::vector<BenchmarkBox>& truth,
                            const std::vector<BenchmarkBox>& tracks, const TrackOf& before) {
  std::vector<int> match(truth.size(), -1);
  std::vector<bool> taken(tracks.size(), false);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const auto last = before.find(truth[i].id);
    for (std::size_t j = 0; last != before.end() && j < tracks.size(); ++j) {
      if (tracks[j].id != last->second || taken[j]) continue;
      if (distanceOf(truth[i], tracks[j]) >= kBenchmarkMatch) continue;
      match[i] = static_cast<int>(j), taken[j] = true;
      break;
    }
  }
  std::vector<std::size_t> rows, columns;
  for (std::size_t i = 0; i < truth.size(); ++i)
    if (match[i] < 0) rows.push_back(i);
  for (std::size_t j = 0; j < tracks.size(); ++j)
    if (!taken[j]) columns.push_back(j);
  if (rows.empty() || columns.empty()) return match;
  // A pair too far apart costs more than all others together.
  const double far = kBenchmarkMatch * static_cast<double>(rows.size() + columns.size() + 1);
  Eigen::MatrixXd cost(rows.size(), columns.size());
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const double distance = distanceOf(truth[rows[r]], tracks[columns[c]]);
      cost(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
          distance < kBenchmarkMatch ? distance : far;
    }
  const std::vector<int> found = optimalAssignment(cost);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (found[r] < 0) continue;
    const std::size_t j = columns[static_cast<std::size_t>(found[r])];
    if (distanceOf(truth[rows[r]], tracks[j]) < kBenchmarkMatch)
      match[rows[r]] = static_cast<int>(j);
  }
  return match;
}

Clear clearOf(const std::vector<BenchmarkFrame>& frames,
              const std::map<std::int64_t, double>& scores, double threshold) {
  Clear clear;
  TrackOf last;
  for (const BenchmarkFrame& frame : frames) {
    std::vector<BenchmarkBox> tracks;
    std::copy_if(frame.tracks.begin(), frame.tracks.end(), std::back_inserter(tracks),
                 [&](const BenchmarkBox& box) { return scores.at(box.id) >= threshold; });
    const std::vector<int> match = matchFrame(frame.truth, tracks, last);
    clear.truth += frame.truth.size();
    std::size_t matched = 0;
    for (std::size_t i = 0; i < match.size(); ++i) {
      if (match[i] < 0) continue;
      const BenchmarkBox& track = tracks[static_cast<std::size_t>(match[i])];
      const auto before = last.find(frame.truth[i].id);
      clear.switches += before != last.end() && before->second != track.id;
      last[frame.truth[i].id] = track.id;
      clear.error += distanceOf(frame.truth[i], track);
      clear.match_scores.push_back(scores.at(track.id));
      ++matched;
    }
    clear.matched += matched;
    clear.false_boxes += tracks.size() - matched;
  }
  return clear;
}

std::map<std::int64_t, double> meanScores(const std::vector<BenchmarkFrame>& frames) {
  std::map<std::int64_t, std::pair<double, double>> sums;
  for (const BenchmarkFrame& frame : frames)
    for (const BenchmarkBox& box : frame.tracks)
      sums[box.id].first += box.score, ++sums[box.id].second;
  std::map<std::int64_t, double> scores;
  for (const auto& [id, sum] : sums) scores[id] = sum.first / sum.second;
  return scores;
}

// The score at which `recall` is reached, linear between the scores of the matches; `scores`:
// falling, the k-th at a recall of k / truth.
double thresholdAt(double recall, const std::vector<double>& scores, double truth) {
  if (recall * truth <= 1) return scores.front();
  const auto recallAt = [&](std::size_t k) { return static_cast<double>(k + 1) / truth; };
  std::size_t k = 0;
  while (k + 1 < scores.size() && recallAt(k + 1) <= recall) ++k;
  if (k + 1 == scores.size() || recallAt(k) == recall) return scores[k];
  const double slope = (scores[k + 1] - scores[k]) / (recallAt(k + 1) - recallAt(k));
  return slope * (recall - recallAt(k)) + scores[k];
}

}  // namespace

BenchmarkFigures trackingBenchmark(const std::vector<BenchmarkFrame>& frames) {
  const auto scores = meanScores(frames);
  Clear all = clearOf(frames, scores, -std::numeric_limits<double>::infinity());
  BenchmarkFigures figures;
  figures.truth = all.truth;
  figures.switches = all.switches, figures.false_boxes = all.false_boxes;
  if (all.truth == 0) return figures;
  figures.recall = all.recall();
  std::sort(all.match_scores.begin(), all.match_scores.end(), std::greater<>());
  const auto P = static_cast<double>(all.truth);
  figures.amotp = 0;
  for (std::size_t i = 0; i < kRecalls; ++i) {
    const double step = (1 - kLeastRecall) / static_cast<double>(kRecalls - 1);
    const double recall = i + 1 == kRecalls ? 1 : kLeastRecall + step * static_cast<double>(i);
    if (all.matched == 0 || recall > static_cast<double>(all.matched) / P) {
      figures.amotp += kBenchmarkMatch / kRecalls;
      continue;
    }
    const Clear at = clearOf(frames, scores, thresholdAt(recall, all.match_scores, P));
    figures.amota += at.motar() / kRecalls;
    figures.amotp +=
        (at.matched > 0 ? at.error / static_cast<double>(at.matched) : kBenchmarkMatch) / kRecalls;
  }
  return figures;
}

std::string benchmarkNameOf(const std::string& truth_type) {
  static const std::map<std::string, std::string> names = {{"Car", "car"},
                                                           {"Van", "car"},
                                                           {"Truck", "truck"},
                                                           {"Bus", "bus"},
                                                           {"Trailer", "trailer"},
                                                           {"Pedestrian", "pedestrian"},
                                                           {"Person", "pedestrian"},
                                                           {"Person_sitting", "pedestrian"},
                                                           {"Cyclist", "bicycle"},
                                                           {"Bicycle", "bicycle"},
                                                           {"Motorcycle", "motorcycle"},
                                                           {"Motorcyclist", "motorcycle"}};
  const auto row = names.find(truth_type);
  return row == names.end() ? "" : row->second;
}

std::string benchmarkNameOf(const std::string& class_name, double length) {
  if (class_name == "car" || class_name == "pedestrian") return class_name;
  if (class_name == "cyclist") return "bicycle";
  if (class_name == "bus") return length >= kBusLength ? "bus" : "truck";
  return "";
}

std::map<std::uint64_t, std::string> benchmarkNamesOf(const TrackedRun& run) {
  struct Sums {
    std::vector<double> classes;
    double length = 0, scenes = 0;
  };
  std::map<std::uint64_t, Sums> sums;
  for (const Scene& scene : run.scenes) {
    for (const SceneObject& o : scene.objects) {
      Sums& s = sums[o.id];
      s.classes.resize(run.class_names.size());
      for (std::size_t c = 0; c < o.class_probability.size(); ++c)
        s.classes[c] += o.class_probability[c];
      s.length += o.length, ++s.scenes;
    }
  }
  std::map<std::uint64_t, std::string> names;
  for (const auto& [id, s] : sums) {
    const auto best = std::max_element(s.classes.begin(), s.classes.end()) - s.classes.begin();
    names[id] =
        benchmarkNameOf(run.class_names[static_cast<std::size_t>(best)], s.length / s.scenes);
  }
  return names;
}

namespace {

double benchmarkRange(const std::string& name) {
  const bool far = name == "car" || name == "truck" || name == "bus" || name == "trailer";
  return far ? kFarClass : kNearClass;
}

}  // namespace

std::vector<BenchmarkFigures> trackingBenchmark(const TrackedRun& run, const GroundTruth& truth,
                                                const AlignmentOptions& options) {
  const auto names = benchmarkNamesOf(run);
  std::map<std::string, std::vector<BenchmarkFrame>> frames;
  std::set<std::int64_t> known, done;
  for (const auto& instant : truth.instants) known.insert(instant.frame);
  std::size_t count = 0;
  for (const TruthAtScene& at : alignTruth(run, truth, options).instants) {
    const Scene& scene = run.scenes[at.scene];
    if (known.count(scene.frame) == 0 || !done.insert(scene.frame).second) continue;
    ++count;
    const Vector2 ego = scene.ego.T_world_ego.translation().head<2>();
    const auto frameOf = [&](const std::string& name) -> BenchmarkFrame& {
      auto& of = frames[name];
      of.resize(count);
      return of.back();
    };
    const auto inRange = [&](const std::string& name, const Vector3& p) {
      return !name.empty() && (p.head<2>() - ego).norm() < benchmarkRange(name);
    };
    for (const TruthObject& o : at.objects) {
      const std::string name = benchmarkNameOf(o.type);
      if (inRange(name, o.position) && o.lidar_points != 0)
        frameOf(name).truth.push_back({o.id, o.position.head<2>(), 0});
    }
    for (const SceneObject& o : scene.objects) {
      const std::string& name = names.at(o.id);
      if (inRange(name, o.position))
        frameOf(name).tracks.push_back(
            {static_cast<std::int64_t>(o.id), o.position.head<2>(), o.existence});
    }
  }
  std::vector<BenchmarkFigures> all;
  for (const auto& [name, of] : frames) {
    BenchmarkFigures figures = trackingBenchmark(of);
    figures.name = name;
    if (figures.truth > 0) all.push_back(std::move(figures));
  }
  return all;
}

}  // namespace perception
