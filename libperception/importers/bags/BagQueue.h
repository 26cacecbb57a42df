#pragma once
#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <string>

#include "libperception/core/Time.h"
#include "libperception/importers/ImportLog.h"
#include "libperception/importers/bags/BagChoices.h"

namespace perception {

/// Puts the sensors' data of a recording in order of their stamps, over a second of recording, and
/// the vehicle's poses among them.
class BagQueue {
 public:
  BagQueue(const BagChoices& choices, ImportLog& log) : choices_(choices), log_(log) {}

  void add(Stamp stamp, std::function<void()> write) { queue_.emplace(stamp, std::move(write)); }
  /// Writes what is older than a message that was recorded now can be.
  void passed(Stamp recorded);
  void finish();
  /// Says how many poses were written: sensors and poses may have clocks that differ.
  void tellPoses() const;

 private:
  void flush(std::optional<Stamp> until);
  void writePoses(Stamp until);

  const BagChoices& choices_;
  ImportLog& log_;
  std::multimap<Stamp, std::function<void()>> queue_;
  std::optional<Stamp> last_;
  std::size_t next_pose_ = 0, written_poses_ = 0;
};

}  // namespace perception
