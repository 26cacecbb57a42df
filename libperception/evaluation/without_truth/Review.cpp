#include "libperception/evaluation/without_truth/Review.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "libperception/core/Csv.h"
#include "libperception/core/Error.h"
#include "libperception/core/math/Random.h"
#include "libperception/evaluation/matching/Footprint.h"
#include "libperception/evaluation/matching/TruthAlignment.h"
#include "libperception/evaluation/metrics/ShareInterval.h"

namespace perception {
namespace {

constexpr std::uint32_t kReviewPurpose = 0x52455655;  // of random numbers

const char* textOf(ReviewAnswer answer) {
  switch (answer) {
    case ReviewAnswer::kYes:
      return "yes";
    case ReviewAnswer::kNo:
      return "no";
    case ReviewAnswer::kUnsure:
      return "unsure";
  }
  return "";
}

bool isNamed(const std::string& name, const std::vector<std::string>& unnamed) {
  return std::find(unnamed.begin(), unnamed.end(), name) == unnamed.end();
}

/// Outputs by class that could be asked about, in order of time.
using Candidates = std::map<std::string, std::vector<ReviewItem>>;

Candidates candidatesOf(const TrackedRun& run, const ReviewOptions& options,
                        const std::vector<std::string>& unnamed) {
  Candidates out;
  for (std::size_t s = 0; s < run.scenes.size(); ++s) {
    const Scene& scene = run.scenes[s];
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      const SceneObject& object = scene.objects[o];
      const auto c = static_cast<std::size_t>(object.class_id);
      const std::string& name = run.class_names[c];
      if (!isNamed(name, unnamed) || object.existence < options.min_existence) continue;
      if (options.sure && !object.classified) continue;
      const GroundView view =
          viewFrom(scene.ego.T_world_ego, makeFootprint(object.position, object.yaw, 0, 0));
      if (!inSector(view, options.range, options.fov)) continue;
      ReviewItem item;
      item.scene = s;
      item.object = o;
      item.t = scene.stamp - run.first_stamp;
      item.id = object.id;
      item.class_name = name;
      item.probability = object.class_probability[c];
      out[name].push_back(item);
    }
  }
  return out;
}

/// How many of each class: equal shares, what a class lacks goes to the others.
std::map<std::string, std::size_t> sharesOf(const Candidates& candidates, std::size_t number) {
  std::map<std::string, std::size_t> shares;
  for (bool given = true; given && number > 0;) {
    given = false;
    for (const auto& [name, items] : candidates) {
      if (number == 0 || shares[name] == items.size()) continue;
      ++shares[name];
      --number;
      given = true;
    }
  }
  return shares;
}

/// Right answers of a class by object.
struct Tally {
  std::size_t outputs = 0, asked = 0, unsure = 0, right = 0, counted = 0;
  std::map<std::uint64_t, std::pair<double, double>> objects;  ///< by id: right, of

  double precision() const { return static_cast<double>(right) / static_cast<double>(counted); }
  /// Variance of the precision when views of one object are alike (method.md 11.1).
  double variance() const {
    const double p = precision(), m = static_cast<double>(objects.size());
    double squares = 0;
    for (const auto& [id, views] : objects) {
      const double residual = views.first - p * views.second;
      squares += residual * residual;
    }
    const double n = static_cast<double>(counted);
    const double grouped = m > 1 ? m / (m - 1) * squares / (n * n) : 0;
    // All right or all wrong, or a single object: as many independent answers as objects.
    const double fewest = p > 0 && p < 1 ? p * (1 - p) / n : 0;
    return std::max(grouped, fewest);
  }
};

/// Precision p of `n` independent answers, not necessarily whole.
void setPrecision(ReviewPrecision& row, double p, double n) {
  const ShareInterval limits = wilsonInterval(p, n);
  row.precision = p;
  row.low = limits.low;
  row.high = limits.high;
}

double effectiveNumber(double p, double variance, double objects) {
  return variance > 0 ? std::max(1.0, p * (1 - p) / variance) : objects;
}

ReviewPrecision rowOf(const std::string& name, const Tally& tally) {
  ReviewPrecision row{name,         tally.outputs, tally.asked,
                      tally.unsure, tally.right,   tally.objects.size()};
  if (tally.counted == 0) return row;
  const double p = tally.precision();
  setPrecision(row, p,
               effectiveNumber(p, tally.variance(), static_cast<double>(tally.objects.size())));
  return row;
}

ReviewPrecision rowOfAll(const std::map<std::string, Tally>& tallies) {
  ReviewPrecision row;
  row.class_name = "all";
  double outputs = 0, p = 0, variance = 0;
  for (const auto& [name, tally] : tallies) {
    row.outputs += tally.outputs;
    row.asked += tally.asked;
    row.unsure += tally.unsure;
    row.right += tally.right;
    row.objects += tally.objects.size();
    if (tally.counted > 0) outputs += static_cast<double>(tally.outputs);
  }
  if (outputs == 0) return row;
  for (const auto& [name, tally] : tallies) {
    if (tally.counted == 0) continue;
    const double weight = static_cast<double>(tally.outputs) / outputs;
    p += weight * tally.precision();
    variance += weight * weight * tally.variance();
  }
  setPrecision(row, p, effectiveNumber(p, variance, static_cast<double>(row.objects)));
  return row;
}

ReviewAnswer answerOf(const SceneObject& object, const std::vector<TruthObject>& truth,
                      const std::vector<std::string>& class_names, double tolerance) {
  bool unknown = false;
  for (const TruthObject& t : truth) {
    // An unlabeled area without a place may be anywhere.
    if (isArea(t) && !t.position.allFinite()) continue;
    const double distance = (t.position - object.position).head<2>().norm();
    if (!(distance <= tolerance)) continue;
    if (t.ignore || isArea(t)) {
      unknown = true;
    } else if (classOfTruth(t.type, class_names) == object.class_id) {
      return ReviewAnswer::kYes;
    }
  }
  return unknown ? ReviewAnswer::kUnsure : ReviewAnswer::kNo;
}

}  // namespace

std::vector<ReviewItem> drawReview(const TrackedRun& run, const ReviewOptions& options,
                                   const std::vector<std::string>& unnamed) {
  Candidates candidates = candidatesOf(run, options, unnamed);
  const auto shares = sharesOf(candidates, options.number);
  std::vector<ReviewItem> drawn;
  std::uint32_t slot = 0;
  for (auto& [name, items] : candidates) {
    Rng rng({options.seed, 0, slot++, kReviewPurpose});
    const std::size_t all = items.size();
    for (std::size_t i = 0; i < shares.at(name); ++i) {
      const std::size_t other = i + rng.below(static_cast<std::uint32_t>(all - i));
      std::swap(items[i], items[other]);
      items[i].outputs = all;
      drawn.push_back(items[i]);
    }
  }
  std::sort(drawn.begin(), drawn.end(), [](const ReviewItem& a, const ReviewItem& b) {
    return std::pair(a.scene, a.object) < std::pair(b.scene, b.object);
  });
  return drawn;
}

void answerByTruth(const TrackedRun& run, const GroundTruth& truth,
                   const EvaluationOptions& options, std::vector<ReviewItem>& items) {
  std::map<std::size_t, std::vector<TruthObject>> known;
  for (auto& instant : alignTruth(run, truth, options.alignment).instants)
    known[instant.scene] = std::move(instant.objects);
  for (ReviewItem& item : items) {
    item.answer = ReviewAnswer::kUnsure;
    const auto at = known.find(item.scene);
    if (at == known.end()) continue;
    const Scene& scene = run.scenes[item.scene];
    const SceneObject& object = scene.objects[item.object];
    const GroundView view =
        viewFrom(scene.ego.T_world_ego, makeFootprint(object.position, object.yaw, 0, 0));
    if (std::abs(view.bearing) > options.selection.complete_fov / 2) continue;
    item.answer = answerOf(object, at->second, run.class_names, options.tolerance);
  }
}

std::string reviewText(const std::string& run, const std::vector<ReviewItem>& items) {
  std::string out = "run,t,id,class,probability,outputs,answer\n";
  for (const ReviewItem& i : items) {
    out += fmt::format("{},{:.9f},{},{},{:.6f},{},{}\n", run, i.t, i.id, i.class_name,
                       i.probability, i.outputs, textOf(i.answer));
  }
  return out;
}

ReviewAnswers readReview(const std::string& path) {
  const CsvTable table = CsvTable::fromFile(path);
  const auto run = table.column("run"), t = table.column("t"), id = table.column("id"),
             name = table.column("class"), probability = table.column("probability"),
             outputs = table.column("outputs"), answer = table.column("answer");
  ReviewAnswers out;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (row == 0) out.run = table.text(row, run);
    if (table.text(row, run) != out.run) table.fault(row, run, "the run of the lines before");
    ReviewItem item;
    item.t = table.real(row, t);
    item.id = table.natural(row, id);
    item.class_name = table.text(row, name);
    item.probability = table.real(row, probability);
    item.outputs = table.natural(row, outputs);
    const std::string_view text = table.text(row, answer);
    if (text == "yes") {
      item.answer = ReviewAnswer::kYes;
    } else if (text == "no") {
      item.answer = ReviewAnswer::kNo;
    } else if (text.empty()) {
      ++out.open;
      continue;
    } else if (text != "unsure") {
      table.fault(row, answer, "yes, no, unsure or nothing");
    }
    out.items.push_back(std::move(item));
  }
  return out;
}

std::vector<ReviewPrecision> reviewPrecision(const std::vector<ReviewItem>& items) {
  std::map<std::string, Tally> tallies;
  for (const ReviewItem& item : items) {
    Tally& tally = tallies[item.class_name];
    tally.outputs = item.outputs;
    ++tally.asked;
    if (item.answer == ReviewAnswer::kUnsure) {
      ++tally.unsure;
      continue;
    }
    const bool right = item.answer == ReviewAnswer::kYes;
    ++tally.counted;
    tally.right += right ? 1 : 0;
    auto& [rights, views] = tally.objects[item.id];
    rights += right ? 1 : 0;
    views += 1;
  }
  std::vector<ReviewPrecision> rows;
  for (const auto& [name, tally] : tallies) rows.push_back(rowOf(name, tally));
  rows.push_back(rowOfAll(tallies));
  return rows;
}

}  // namespace perception
