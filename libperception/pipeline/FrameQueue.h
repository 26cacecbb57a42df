#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// Puts sensor frames into the order of time: holds them for a window, because sensors report late
/// (method.md 1.2). Frames of one instant come out together, by label. The result does not depend
/// on the order of arrival within the window.
class FrameQueue {
 public:
  struct Params {
    double window = 0.2;     ///< [s] how late a frame may come
    std::size_t limit = 70;  ///< frames held at most; the oldest go early beyond it
  };
  enum class Verdict { kTaken, kTooLate, kDuplicate };

  explicit FrameQueue(Params params) : params_(params) {}

  Verdict push(SensorFrame frame);
  /// Time has come to `stamp` even if no frame says so (poses, other entries of the log).
  void advance(Stamp stamp);
  /// All frames of the oldest instant, once nothing older can come; with `flush` at once.
  std::vector<SensorFrame> pop(bool flush);
  /// Takes frames up to `until` whose label `wanted` accepts, in the order of time, before their
  /// turn.
  std::vector<SensorFrame> take(Stamp until, const std::function<bool(const std::string&)>& wanted);
  bool empty() const { return frames_.empty(); }
  /// Forgets everything, as after a jump of the clock.
  void clear();

 private:
  Params params_;
  std::map<std::pair<std::int64_t, std::string>, SensorFrame> frames_;  ///< by stamp [ns] and label
  Stamp newest_;
  std::optional<Stamp> popped_;
};

}  // namespace perception
