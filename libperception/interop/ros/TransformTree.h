#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/interop/ros/PoseSeries.h"

namespace perception {

/// Coordinate frames, each with its pose in its parent: fixed, or moving with time (ROS's tf2).
class TransformTree {
 public:
  /// p_parent = T p_child. Stamps in any order. Of a fixed frame the last one holds for all times.
  /// settle() or keep() comes behind the last of them, before all questions.
  void add(const std::string& parent, const std::string& child, Stamp stamp, const Pose3& T,
           bool fixed);
  void settle();

  /// T_to_from. Between stamps: linear in position, slerp in attitude; up to 0.2 s beyond the ends
  /// the pose there. Empty: no chain, or no pose near the stamp.
  std::optional<Pose3> at(const std::string& to, const std::string& from, Stamp stamp) const;

  bool has(const std::string& frame) const;
  /// The highest ancestor of a frame, if one of the steps to it moves; empty: none.
  std::string movesIn(const std::string& frame) const;
  /// The poses of the nearest moving step above a frame, in order; null: none moves.
  const PoseSeries* movingStep(const std::string& frame) const;
  /// Frames that move in a parent without a parent of its own, by name.
  std::vector<std::string> moving() const;
  /// The nearest frame that moves in its parent, at or above a frame; empty: none.
  std::string moverOf(const std::string& frame) const;
  /// Whether `above` is above a frame, and a step between them moves: the frame travels in it.
  bool travelsIn(const std::string& above, const std::string& frame) const;
  /// The highest ancestor of a frame; itself without any.
  std::string rootOf(const std::string& frame) const { return ancestors(frame).back(); }
  /// Until when all steps at and above a frame are known without a look beyond their ends; the
  /// end of time where none of them moves.
  Stamp knownUntil(const std::string& frame) const;
  /// Forgets poses of a moving frame: all behind `until`, those before `from` from time to time;
  /// one always stays. Puts them in order, as settle() does.
  void keep(const std::string& child, Stamp from, Stamp until);

 private:
  struct Step {
    std::string parent;
    bool fixed = true;
    PoseSeries poses;
  };
  /// From a frame upward; each frame once, even in a ring.
  std::vector<std::string> ancestors(const std::string& frame) const;
  std::optional<Pose3> inParent(const Step& step, Stamp stamp) const;

  std::map<std::string, Step> steps_;  ///< by child
};

}  // namespace perception
