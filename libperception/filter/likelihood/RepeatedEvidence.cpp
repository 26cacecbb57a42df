#include "libperception/filter/likelihood/RepeatedEvidence.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace perception {
namespace {

const EvidenceSeen* seenBy(const Track& track, const std::string& sensor) {
  if (track.evidence.empty()) return nullptr;
  const std::uint64_t key = sensorKey(sensor);
  for (const EvidenceSeen& e : track.evidence)
    if (e.sensor == key) return &e;
  return nullptr;
}

double meanWith(double views, double mean, double worth, double value) {
  return (views * mean + worth * value) / (views + worth);
}

}  // namespace

RepeatedEvidence::RepeatedEvidence(const Track& track, const Measurement& m,
                                   const MeasurementScan& scan, double epsilon)
    : m_(m) {
  if (!m.view) return;
  memory_ = scan.model->evidenceMemory();
  if (!memory_) return;
  seen_ = seenBy(track, scan.sensor);
  if (!seen_) return;
  worth_ = EvidenceMemory::worth(
      memory_->correlation(*m.view, seen_->view, scan.state.stamp - seen_->stamp));
  kept_ = seen_->views * memory_->say(*m.view, seen_->view);
  if (epsilon <= 0) return;
  floor_ = std::log(epsilon);
  best_before_ = best_now_ = -std::numeric_limits<double>::infinity();
  for (std::size_t j = 0; j < m.log_class.size(); ++j) {
    best_before_ = std::max(best_before_, memory_->looks(seen_->views) * seen_->mean[j]);
    best_now_ = std::max(best_now_, memory_->looks(views()) * mean(j));
  }
}

double RepeatedEvidence::total(double looks, double value, double best) const {
  return std::max(looks * value, best + floor_);
}

double RepeatedEvidence::added(std::size_t j) const {
  if (!seen_) return m_.log_class[j];
  return total(memory_->looks(views()), mean(j), best_now_) -
         total(memory_->looks(seen_->views), seen_->mean[j], best_before_);
}

double RepeatedEvidence::mean(std::size_t j) const {
  return seen_ ? meanWith(kept_, seen_->mean[j], worth_, m_.log_class[j]) : m_.log_class[j];
}

void rememberEvidence(const Measurement& m, const MeasurementScan& scan, Track& track) {
  const RepeatedEvidence evidence(track, m, scan);
  if (!evidence.applies()) return;
  const std::uint64_t key = sensorKey(scan.sensor);
  EvidenceSeen now{key, scan.state.stamp, *m.view, evidence.views(), {}};
  for (std::size_t j = 0; j < m.log_class.size(); ++j) now.mean.push_back(evidence.mean(j));
  const auto seen = std::find_if(track.evidence.begin(), track.evidence.end(),
                                 [&](const EvidenceSeen& e) { return e.sensor == key; });
  if (seen == track.evidence.end()) {
    track.evidence.push_back(std::move(now));
  } else {
    *seen = std::move(now);
  }
}

}  // namespace perception
