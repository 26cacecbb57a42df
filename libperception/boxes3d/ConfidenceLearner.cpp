#include "libperception/boxes3d/ConfidenceLearner.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "libperception/core/Frames.h"

namespace perception {
namespace {

constexpr std::size_t kMostSamples = 2000;  // about a hundred frames of KITTI
constexpr std::size_t kFewSamples = 400;    // up to which every frame is fitted
constexpr int kFramesPerFit = 5, kSteps = 3;
constexpr double kWeight = 1;      // of a sample: frames alike persist alike (assumed)
constexpr double kMostSpread = 4;  // standard deviations of scores: farther ones count as that

// Share of the surest boxes of five networks that the next three frames have again.
constexpr double kPersisting = 0.945;
// Log-odds of an object by those of persistence: kSlope z + kOffset + kByRange (range - 25 m) / 25
// m (method.md 8.12).
constexpr double kSlope = 0.93, kOffset = -0.25, kByRange = 0.26;
constexpr double kMiddle = 25;  // [m]

// Prior of the weights of 1, score and range, in standard deviations of the scores and 25 m.
const Vector3 kPriorMean(0, 1, 0), kPriorPrecision(1 / 9.0, 1 / 4.0, 1);

constexpr std::size_t kFrames = 3;          // that have to have a box again
constexpr double kLongestGap = 0.3;         // [s] between frames that are compared
constexpr double kGate = 0.5, kSpeed = 25;  // [m], [m/s] of what is the same (assumed)
// [m], [m/s^2] ways of successive frames that differ by more are not of one object: three standard
// deviations of three centers with 0.1 m in each axis, and what road users do (assumed).
constexpr double kUneven = 0.6, kAccel = 10;
constexpr double kNearest = 6;         // [m] nearer ones leave the view
constexpr double kInnerView = 0.85;    // [-] of the field of view: the same
constexpr double kObjectsMemory = 50;  // [frames] (assumed)
constexpr std::size_t kFewScores = 5;  // fewer give no unit
constexpr double kLeastObjects = 0.05;

double standardDeviation(const std::vector<double>& values, double mean) {
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(std::max<std::size_t>(1, values.size())));
}

double meanOf(const std::vector<double>& values) {
  double sum = 0;
  for (const double v : values) sum += v;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace

void PersistenceFit::add(const Sample& sample) {
  samples_.push_back(sample);
  if (samples_.size() > kMostSamples) samples_.pop_front();
}

void PersistenceFit::start(const std::vector<double>& scores) {
  if (scaled_ || scores.size() < kFewScores) return;
  center_ = meanOf(scores);
  unit_ = std::max(standardDeviation(scores, center_), 1e-9);
  scaled_ = true;
}

void PersistenceFit::standardize() {
  std::vector<double> scores;
  scores.reserve(samples_.size());
  for (const Sample& s : samples_) scores.push_back(s.score);
  scaled_ = false;
  start(scores);
}

Vector3 PersistenceFit::rowOf(double score, double range) const {
  const double z = scaled_ ? std::clamp((score - center_) / unit_, -kMostSpread, kMostSpread) : 0;
  return {1, z, (range - kMiddle) / kMiddle};
}

// Fisher scoring; the share of persisting boxes is kPersisting times a logistic function.
void PersistenceFit::fit() {
  if (samples_.size() < kFewScores) return;
  standardize();
  Eigen::Matrix3d information = kPriorPrecision.asDiagonal();
  for (int step = 0; step < kSteps; ++step) {
    Vector3 gradient = kPriorPrecision.cwiseProduct(kPriorMean - weights_);
    information = kPriorPrecision.asDiagonal();
    for (const Sample& s : samples_) {
      const Vector3 x = rowOf(s.score, s.range);
      const double q = 1 / (1 + std::exp(-weights_.dot(x)));
      const double p = std::clamp(kPersisting * q, 1e-6, 1 - 1e-6);
      const double change = kPersisting * q * (1 - q);
      gradient += kWeight * ((s.persists ? 1 : 0) - p) / (p * (1 - p)) * change * x;
      information += kWeight * change * change / (p * (1 - p)) * x * x.transpose();
    }
    weights_ += information.ldlt().solve(gradient);
    weights_ = weights_.cwiseMax(-10).cwiseMin(10);
    weights_[1] = std::max(weights_[1], 0.0);  // a higher score is never worse
  }
  covariance_ = information.inverse();
}

double PersistenceFit::logOdds(double score, double range) const {
  const Vector3 x = rowOf(score, range);
  const double variance = x.dot(covariance_ * x);
  return kSlope * weights_.dot(x) / std::sqrt(1 + kPi / 8 * variance) + kOffset + kByRange * x[2];
}

ScoreOdds PersistenceFit::odds() const {
  ScoreOdds odds;
  odds.slope = scaled_ ? kSlope * weights_[1] / unit_ : 0;
  const double by_range = kSlope * weights_[2] + kByRange;
  odds.fade = -by_range / kMiddle;
  const double at_center = kSlope * weights_[0] + kOffset - by_range;  // at range 0
  odds.offset = odds.slope > 0 ? center_ - at_center / odds.slope : 0;
  return odds;
}

ConfidenceLearner::ConfidenceLearner(Params params)
    : params_(std::move(params)), labels_(params_.labels.size()) {}

ConfidenceLearner::Frame ConfidenceLearner::boxesOf(const SensorFrame& frame) const {
  Frame boxes{frame.stamp, {}};
  const auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (detections == nullptr) return boxes;
  const Pose3 T_world_sensor = frame.T_world_sensor();
  for (const ObjectDetection& object : detections->objects) {
    const auto label = params_.label_of.find(object.label);
    Box box{label == params_.label_of.end() || !object.space_box ? -1 : label->second,
            Vector2::Zero(), object.score, 0, false};
    if (box.label >= 0 && object.space_box->bottom_center.allFinite()) {
      const Vector3& at = object.space_box->bottom_center;
      box.place = (T_world_sensor * at).head<2>();
      box.range = at.head<2>().norm();
      box.stays_in_view = box.range > kNearest &&
                          std::abs(std::atan2(at.y(), at.x())) < kInnerView * params_.fov / 2;
    } else {
      box.label = -1;
    }
    boxes.boxes.push_back(box);
  }
  return boxes;
}

/// Boxes of one label that are each other's nearest within the way of fast traffic.
void ConfidenceLearner::link(Frame& now) const {
  if (last_.empty()) return;
  const Frame& before = last_.back();
  const double gate = kGate + kSpeed * (now.stamp - before.stamp);
  const auto nearest = [&](const Box& box, const std::vector<Box>& others) {
    int best = -1;
    double least = gate * gate;
    for (std::size_t i = 0; i < others.size(); ++i) {
      const double d = (others[i].place - box.place).squaredNorm();
      if (others[i].label == box.label && d < least) least = d, best = static_cast<int>(i);
    }
    return best;
  };
  for (std::size_t i = 0; i < now.boxes.size(); ++i) {
    if (now.boxes[i].label < 0) continue;
    const int earlier = nearest(now.boxes[i], before.boxes);
    if (earlier < 0) continue;
    const Box& box = before.boxes[static_cast<std::size_t>(earlier)];
    if (nearest(box, now.boxes) == static_cast<int>(i)) now.boxes[i].before = earlier;
  }
}

/// What a box of `now` was in the oldest frame, -1: not there all the time, or on a way that no
/// vehicle takes, as false boxes that lie near each other by chance.
int ConfidenceLearner::tracedBack(const Frame& now, const Box& box) const {
  const Frame* frame = &now;
  const Box* at = &box;
  std::optional<Vector2> velocity;
  int i = -1;
  for (std::size_t k = kFrames; k-- > 0;) {
    i = at->before;
    if (i < 0) return -1;
    const Frame& earlier = last_[k];
    const Box& there = earlier.boxes[static_cast<std::size_t>(i)];
    const double dt = frame->stamp - earlier.stamp;
    const Vector2 way = at->place - there.place;
    if (velocity && (way - dt * *velocity).norm() > kUneven + kAccel * dt * dt) return -1;
    velocity = way / dt;
    frame = &earlier;
    at = &there;
  }
  return i;
}

/// From the boxes of kFrames frames ago.
void ConfidenceLearner::addSamples(const Frame& now) {
  if (last_.size() < kFrames) return;
  const Frame& first = last_.front();
  std::vector<char> persists(first.boxes.size(), 0);
  for (const Box& box : now.boxes) {
    const int i = tracedBack(now, box);
    if (i >= 0) persists[static_cast<std::size_t>(i)] = 1;
  }
  for (std::size_t i = 0; i < first.boxes.size(); ++i) {
    const Box& box = first.boxes[i];
    if (box.label < 0 || !box.stays_in_view) continue;
    labels_[static_cast<std::size_t>(box.label)].fit.add({box.score, box.range, persists[i] != 0});
  }
}

std::vector<double> ConfidenceLearner::learn(const SensorFrame& frame) {
  Frame now = boxesOf(frame);
  const double passed = last_.empty() ? 0 : now.stamp - last_.back().stamp;
  if (passed <= 0 || passed > kLongestGap) last_.clear();
  link(now);
  addSamples(now);
  for (std::size_t l = 0; l < labels_.size(); ++l) {
    Label& label = labels_[l];
    std::vector<double> scores;
    for (const Box& b : now.boxes)
      if (b.label == static_cast<int>(l)) scores.push_back(b.score);
    label.fit.start(scores);
    if (label.frames++ % kFramesPerFit == 0 || label.fit.samples() < kFewSamples) label.fit.fit();
    double objects = 0;
    for (const Box& b : now.boxes)
      if (b.label == static_cast<int>(l))
        objects += 1 / (1 + std::exp(-label.fit.logOdds(b.score, b.range)));
    label.objects = label.objects
                        ? *label.objects + (objects - *label.objects) /
                                               std::min<double>(label.frames, kObjectsMemory)
                        : objects;
  }
  std::vector<double> log_odds;
  for (const Box& b : now.boxes) {
    log_odds.push_back(
        b.label < 0 ? std::numeric_limits<double>::quiet_NaN()
                    : labels_[static_cast<std::size_t>(b.label)].fit.logOdds(b.score, b.range));
  }
  last_.push_back(std::move(now));
  if (last_.size() > kFrames) last_.pop_front();
  return log_odds;
}

void ConfidenceLearner::apply(SensorFrame& frame) {
  auto* detections = std::get_if<ObjectDetections>(&frame.data);
  if (detections == nullptr) return;
  const std::vector<double> log_odds = learn(frame);
  for (std::size_t i = 0; i < log_odds.size(); ++i) {
    const int of = last_.back().boxes[i].label;
    if (of < 0) continue;
    const Label& label = labels_[static_cast<std::size_t>(of)];
    const double expected = std::max(*label.objects, kLeastObjects) / params_.clutter_per_scan;
    detections->objects[i].score = log_odds[i] - std::log(expected);
  }
}

std::vector<std::string> ConfidenceLearner::learned() const {
  std::vector<std::string> lines;
  for (std::size_t l = 0; l < labels_.size(); ++l) {
    const Label& label = labels_[l];
    if (!label.objects || label.fit.samples() == 0) continue;
    if (lines.empty()) lines.emplace_back("confidence = fixed");
    const ScoreOdds odds = label.fit.odds();
    const std::string& name = params_.labels[l];
    lines.push_back(fmt::format("score_slope.{} = {:.4g}", name, odds.slope));
    lines.push_back(fmt::format("score_offset.{} = {:.4g}", name, odds.offset));
    lines.push_back(fmt::format("score_fade.{} = {:.4g}", name, odds.fade));
    lines.push_back(
        fmt::format("score_balance.{} = {:.4g}", name,
                    std::log(std::max(*label.objects, kLeastObjects) / params_.clutter_per_scan)));
  }
  return lines;
}

}  // namespace perception
