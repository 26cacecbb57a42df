#pragma once
#include <mrpt/obs/CObservation.h>

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/importers/bags/BagContents.h"

namespace perception {

/// The vehicle's poses in a running graph, from its transforms or from a topic of poses.
class RosPoses {
 public:
  using Give = std::function<void(std::shared_ptr<mrpt::obs::CObservation>)>;

  /// `source`: tf, none, a topic; empty: transforms if they move the vehicle, else the first topic
  /// of poses, else none. `contents` outlives this.
  RosPoses(BagContents& contents, const std::string& source, Give give);

  void setBase(const std::string& frame, const Pose3& T_ego_base);
  /// Takes over the transforms that a reader has put into the contents; memory is bounded. Throws
  /// std::runtime_error where there are more frames than a graph can have.
  void plant(Stamp received);
  /// Gives poses up to `until`, after setBase(). One of a chain of moving frames waits for a tenth
  /// of a second until all of them are known at its stamp. `waited`: what there is has come.
  void give(Stamp now, bool waited, Stamp until);

  /// What was taken.
  std::string note() const;
  /// Empty: nothing is wrong.
  std::string fault() const;

 private:
  struct Move {  ///< of a frame in its parent
    std::string child;
    Stamp stamp, received;
  };

  void choose(bool waited);
  void giveOfTree(Stamp now, Stamp until);
  void giveOfTopics(Stamp until);
  void givePose(Stamp stamp, const Pose3& T_world_base);

  BagContents& contents_;
  Give give_;
  std::string base_;
  Pose3 T_ego_base_ = Pose3::Identity();
  std::optional<std::string> from_;  ///< tf, none, a topic; empty: not chosen yet
  std::set<std::string> frames_;     ///< that have a parent
  std::deque<Move> moves_;           ///< whose poses are not given yet
  std::optional<Stamp> last_;
  std::uint64_t given_ = 0;
};

}  // namespace perception
