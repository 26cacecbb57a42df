#include "libperception/pipeline/watches/InnovationWatch.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <optional>

#include "libperception/filter/likelihood/Innovation.h"
#include "libperception/filter/likelihood/Linearization.h"
#include "libperception/filter/predict/Prediction.h"
#include "libperception/filter/state/ClassFilterMotion.h"

namespace perception {
namespace {

constexpr double kSettled = 0.5;        ///< [s] of a track's life: its first speed is a guess
constexpr double kExistence = 0.9;      ///< of tracks that count
constexpr double kApart = 1;            ///< [s] updates further apart are not successive
constexpr double kLargest = 10;         ///< of |e|: one lost track does not make the mean
constexpr std::size_t kForget = 10000;  ///< entries of which the old ones are dropped

/// The measurement that led from one history to the other, if a single one did.
std::optional<std::size_t> causeOf(const Track& before, const Track& after, std::uint64_t index,
                                   std::size_t measurements) {
  if (before.history == after.history) return {};
  for (std::size_t m = 0; m < measurements; ++m)
    if (extendHistory(before.history, index, m) == after.history) return m;
  return {};
}

/// e = L^-1 y of a class filter and a measurement; empty without a prediction of the sensor.
std::optional<AxisVector> standardizedOf(const Track& predicted, ClassId c, const Measurement& m,
                                         const MeasurementScan& scan, const FilterModel& model) {
  const ClassFilter& f = predicted.bank[predicted.filterOf(static_cast<std::size_t>(c))];
  const Kinematics at = kinematicsOf(model.classes[c], f);
  // Models predict whole banks: the filter stands at the index of its class.
  const std::vector<Kinematics> kinematics(static_cast<std::size_t>(c) + 1, at);
  const std::vector<Extent> extents(kinematics.size(), f.extent);
  std::vector<AxisPrediction> seen(kinematics.size());
  scan.model->predict(kinematics.data(), extents.data(), kinematics.size(), scan.state,
                      seen.data());
  if (!seen.back().defined) return {};
  linearizeAlongAspect(model.classes[c], f, at, *scan.model, scan.state, seen.back());
  scan.model->addClassNoise(c, at, scan.state, seen.back());
  const Innovation innovation = innovationOf(f, at, seen.back(), m, *scan.model);
  const Eigen::LLT<AxisMatrix> llt(innovation.S);
  if (llt.info() != Eigen::Success) return {};
  AxisVector e = llt.matrixL().solve(innovation.y);
  if (!e.allFinite()) return {};
  return e.cwiseMax(-kLargest).cwiseMin(kLargest);
}

}  // namespace

InnovationSums& InnovationSums::operator+=(const InnovationSums& other) {
  updates += other.updates, axes += other.axes, squares += other.squares;
  pairs_axes += other.pairs_axes, products += other.products, pair_squares += other.pair_squares;
  return *this;
}

void InnovationWatch::before(const CRbpfTracker& tracker) {
  before_.clear();
  for (const TrackHandle& track : tracker.mapHypothesis().tracks)
    if (track->real() >= kExistence && track->stamp - track->birth >= kSettled)
      before_.push_back(track);
}

void InnovationWatch::after(const CRbpfTracker& tracker, const MeasurementScan& scan,
                            std::uint64_t index) {
  std::unordered_map<std::uint64_t, const Track*> now;
  for (const TrackHandle& track : tracker.mapHypothesis().tracks) now.emplace(track->id, &*track);
  for (const TrackHandle& track : before_) {
    const auto found = now.find(track->id);
    if (found == now.end()) continue;
    const auto m = causeOf(*track, *found->second, index, scan.measurements.size());
    if (m) add(*track, *found->second, scan, *m, tracker.model());
  }
  before_.clear();
  if (last_.size() < kForget) return;
  for (auto it = last_.begin(); it != last_.end();)
    it = scan.state.stamp - it->second.stamp > kApart ? last_.erase(it) : std::next(it);
}

void InnovationWatch::add(const Track& before, const Track& after, const MeasurementScan& scan,
                          std::size_t measurement, const FilterModel& model) {
  const Measurement& m = scan.measurements[measurement];
  const ClassId c = before.decided_class < 0 ? before.likeliestClass() : before.decided_class;
  const Track predicted = predictTrack(before, scan.state.stamp, model);
  const auto e = standardizedOf(predicted, c, m, scan, model);
  if (!e) return;
  InnovationSums& sums = sums_[{scan.sensor, after.likeliestClass()}];
  ++sums.updates;
  sums.axes += static_cast<std::uint64_t>(e->size());
  sums.squares += e->squaredNorm();
  Last& last = last_[before.id ^ sensorKey(scan.sensor)];
  if (last.seen == m.seen && last.standardized.size() == e->size() &&
      scan.state.stamp - last.stamp <= kApart) {
    sums.pairs_axes += static_cast<std::uint64_t>(e->size());
    sums.products += e->dot(last.standardized);
    sums.pair_squares += e->squaredNorm();
  }
  last = {scan.state.stamp, m.seen, *e};
}

std::string innovationsCsv(const InnovationWatch::Sums& sums, const ClassTable& classes) {
  std::string text = "sensor,class,updates,axes,nis,pair_axes,lag1\n";
  for (const auto& [key, s] : sums)
    text += fmt::format("{},{},{},{},{:.4f},{},{}\n", key.first, classes[key.second].name,
                        s.updates, s.axes, s.axes > 0 ? s.nis() : 0, s.pairs_axes,
                        s.pair_squares > 0 ? fmt::format("{:.4f}", s.lag1()) : "");
  return text;
}

}  // namespace perception
