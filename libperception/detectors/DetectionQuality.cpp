#include "libperception/detectors/DetectionQuality.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "libperception/core/math/Angle.h"
#include "libperception/detectors/Suppression.h"

namespace perception {
namespace {

/// Area under f over recall, with f made monotone from the right.
double areaUnder(const std::vector<double>& recall, std::vector<double> f) {
  double area = 0, before = 0;
  for (std::size_t i = f.size(); i-- > 1;) f[i - 1] = std::max(f[i - 1], f[i]);
  for (std::size_t i = 0; i < f.size(); ++i) {
    area += f[i] * (recall[i] - before);
    before = recall[i];
  }
  return area;
}

void addHeadings(const std::vector<JudgedBox>& boxes, LabelQuality& q) {
  std::vector<double> axis;
  double squares = 0;
  for (const JudgedBox& b : boxes) {
    if (!b.right || !b.heading_error) continue;
    double error = std::abs(*b.heading_error);
    ++q.headings;
    if (error > kPi / 2) {
      ++q.flips;
      error = kPi - error;
    }
    axis.push_back(error);
    squares += error * error;
  }
  if (axis.empty()) return;
  std::sort(axis.begin(), axis.end());
  q.heading_median = axis[axis.size() / 2];
  q.heading_rms = std::sqrt(squares / static_cast<double>(axis.size()));
}

}  // namespace

void DetectionQuality::add(const std::vector<LabeledBox>& labels,
                           const std::vector<ObjectDetection>& objects) {
  std::set<std::string> names;
  for (const LabeledBox& l : labels) {
    if (!l.area && !l.ignore) names.insert(l.label);
  }
  for (const ObjectDetection& o : objects) names.insert(o.label);
  for (const std::string& name : names) addLabel(name, labels, objects);
}

void DetectionQuality::addLabel(const std::string& name, const std::vector<LabeledBox>& labels,
                                const std::vector<ObjectDetection>& objects) {
  Row& row = rows_[name];
  std::vector<const ObjectDetection*> found;
  for (const ObjectDetection& o : objects) {
    if (o.label == name && o.image_box) found.push_back(&o);
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const auto* a, const auto* b) { return a->score > b->score; });
  const auto counts = [&](const LabeledBox& l) { return l.label == name && !l.ignore && !l.area; };
  for (const LabeledBox& l : labels) row.labeled += counts(l) ? 1 : 0;
  std::vector<bool> taken(labels.size(), false);
  for (const ObjectDetection* o : found) {
    int best = -1;
    double best_overlap = overlap_;
    bool ignored = false;
    for (std::size_t i = 0; i < labels.size(); ++i) {
      const double overlap = overlapOf(*o->image_box, labels[i].box);
      if (labels[i].area) {
        ignored = ignored || sharedArea(*o->image_box, labels[i].box) > 0.5 * areaOf(*o->image_box);
      } else if (labels[i].ignore) {
        ignored = ignored || (labels[i].label == name && overlap >= overlap_);
      } else if (counts(labels[i]) && !taken[i] && overlap >= best_overlap) {
        best = static_cast<int>(i);
        best_overlap = overlap;
      }
    }
    JudgedBox judged{o->score, best >= 0, o->image_box->y2 - o->image_box->y1, {}};
    if (best >= 0) {
      const LabeledBox& label = labels[static_cast<std::size_t>(best)];
      taken[static_cast<std::size_t>(best)] = true;
      if (o->heading && label.heading)
        judged.heading_error = wrapAngle(*o->heading - *label.heading);
    } else if (ignored || judged.height < min_height_) {
      continue;
    }
    row.boxes.push_back(judged);
  }
}

std::vector<std::string> DetectionQuality::labels() const {
  std::vector<std::string> out;
  for (const auto& [name, row] : rows_) out.push_back(name);
  return out;
}

const std::vector<JudgedBox>& DetectionQuality::judged(const std::string& label) const {
  static const std::vector<JudgedBox> none;
  const auto row = rows_.find(label);
  return row == rows_.end() ? none : row->second.boxes;
}

std::vector<LabelQuality> DetectionQuality::results() const {
  std::vector<LabelQuality> out;
  for (const auto& [name, row] : rows_) {
    LabelQuality q;
    q.label = name;
    q.labeled = row.labeled;
    std::vector<JudgedBox> boxes = row.boxes;
    std::stable_sort(boxes.begin(), boxes.end(),
                     [](const auto& a, const auto& b) { return a.score > b.score; });
    std::vector<double> recall, precision, similarity;
    double alike = 0;
    for (const JudgedBox& b : boxes) {
      ++(b.right ? q.right : q.wrong);
      if (b.heading_error) alike += 0.5 * (1 + std::cos(*b.heading_error));
      const double all = q.right + q.wrong;
      recall.push_back(row.labeled > 0 ? static_cast<double>(q.right) / row.labeled : 0.0);
      precision.push_back(q.right / all);
      similarity.push_back(alike / all);
      q.curve.push_back({b.score, recall.back(), precision.back()});
    }
    q.recall = recall.empty() ? 0 : recall.back();
    q.average_precision = areaUnder(recall, precision);
    q.orientation_similarity = areaUnder(recall, similarity);
    addHeadings(boxes, q);
    out.push_back(std::move(q));
  }
  return out;
}

std::optional<Logistic> fitLogistic(const std::vector<JudgedBox>& boxes) {
  double right = 0, wrong = 0, mean = 0;
  for (const JudgedBox& b : boxes) {
    ++(b.right ? right : wrong);
    mean += b.score / static_cast<double>(boxes.size());
  }
  if (right == 0 || wrong == 0) return std::nullopt;
  const double target_right = (right + 1) / (right + 2), target_wrong = 1 / (wrong + 2);
  double a = 1, b = std::log((right + 1) / (wrong + 1));  // log-odds = a (score - mean) + b
  const auto loss = [&](double a1, double b1) {
    double sum = 0;
    for (const JudgedBox& box : boxes) {
      const double t = box.right ? target_right : target_wrong, z = a1 * (box.score - mean) + b1;
      sum += std::max(z, 0.0) - t * z + std::log1p(std::exp(-std::abs(z)));
    }
    return sum;
  };
  for (int round = 0; round < 100; ++round) {  // Newton's method with step halving
    double ga = 0, gb = 0, haa = 1e-9, hab = 0, hbb = 1e-9;
    for (const JudgedBox& box : boxes) {
      const double t = box.right ? target_right : target_wrong, x = box.score - mean;
      const double p = 1 / (1 + std::exp(-(a * x + b))), w = p * (1 - p);
      ga += (p - t) * x;
      gb += p - t;
      haa += w * x * x;
      hab += w * x;
      hbb += w;
    }
    const double det = haa * hbb - hab * hab;
    if (det <= 0) break;
    const double da = (hbb * ga - hab * gb) / det, db = (haa * gb - hab * ga) / det;
    double step = 1;
    while (step > 1e-6 && loss(a - step * da, b - step * db) > loss(a, b)) step /= 2;
    a -= step * da;
    b -= step * db;
    if (std::abs(da) + std::abs(db) < 1e-10) break;
  }
  if (!(a > 0)) return std::nullopt;
  return Logistic{a, mean - b / a};
}

}  // namespace perception
