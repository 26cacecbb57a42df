#include "libperception/pipeline/input/FrameQueue.h"

#include <algorithm>

namespace perception {

FrameQueue::Verdict FrameQueue::push(SensorFrame frame) {
  if (popped_ && frame.stamp <= *popped_) return Verdict::kTooLate;
  newest_ = std::max(newest_, frame.stamp);
  const auto key = std::make_pair(frame.stamp.ns, frame.sensor);
  return frames_.try_emplace(key, std::move(frame)).second ? Verdict::kTaken : Verdict::kDuplicate;
}

void FrameQueue::advance(Stamp stamp) { newest_ = std::max(newest_, stamp); }

std::vector<SensorFrame> FrameQueue::pop(bool flush) {
  std::vector<SensorFrame> out;
  if (frames_.empty()) return out;
  const Stamp oldest{frames_.begin()->first.first};
  if (!flush && newest_ - oldest <= params_.window && frames_.size() <= params_.limit) return out;
  while (!frames_.empty() && frames_.begin()->first.first == oldest.ns) {
    out.push_back(std::move(frames_.begin()->second));
    frames_.erase(frames_.begin());
  }
  popped_ = oldest;
  return out;
}

std::vector<SensorFrame> FrameQueue::take(Stamp until,
                                          const std::function<bool(const std::string&)>& wanted) {
  std::vector<SensorFrame> out;
  for (auto it = frames_.begin(); it != frames_.end() && it->first.first <= until.ns;) {
    if (wanted(it->first.second)) {
      out.push_back(std::move(it->second));
      it = frames_.erase(it);
    } else {
      ++it;
    }
  }
  return out;
}

void FrameQueue::clear() {
  frames_.clear();
  newest_ = {};
  popped_.reset();
}

}  // namespace perception
