#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// Reorder buffer: sorts sensor frames by stamp within a window, since sensors report late
/// (method.md 1.2). Frames of one stamp are returned together, sorted by label. The result does not
/// depend on the order of arrival within the window.
class FrameQueue {
 public:
  struct Params {
    double window = 0.2;     ///< [s] largest delay of a frame
    std::size_t limit = 70;  ///< most frames held; beyond it the oldest are returned early
  };
  enum class Verdict { kTaken, kTooLate, kDuplicate };

  explicit FrameQueue(Params params) : params_(params) {}

  Verdict push(SensorFrame frame);
  /// Advances the time to `stamp`, for entries of the log that are not frames.
  void advance(Stamp stamp);
  /// All frames of the oldest stamp once its window has passed; with `flush` at once. Empty: none.
  std::vector<SensorFrame> pop(bool flush);
  /// Removes frames up to `until` whose label `wanted` accepts, in chronological order, before
  /// their window has passed.
  std::vector<SensorFrame> take(Stamp until, const std::function<bool(const std::string&)>& wanted);
  bool empty() const { return frames_.empty(); }
  /// Clears all state, as after a clock jump.
  void clear();

 private:
  Params params_;
  std::map<std::pair<std::int64_t, std::string>, SensorFrame> frames_;  ///< by stamp [ns] and label
  Stamp newest_;
  std::optional<Stamp> popped_;
};

}  // namespace perception
