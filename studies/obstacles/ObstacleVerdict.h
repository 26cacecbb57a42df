#pragma once
#include <array>
#include <cstddef>
#include <limits>
#include <vector>

#include "libperception/core/Time.h"
#include "studies/obstacles/ObstacleShapes.h"
#include "studies/obstacles/StopCount.h"

namespace perception {

/// Who calls for stops: the run's own advice, and plain Euclidean clusters.
enum class StopCaller { kAdvice, kClusters };
inline constexpr std::size_t kStopCallers = 2;

/// What one scene of a drive showed. Distances [m] are along the way from the vehicle's front;
/// infinity: none.
struct ObstacleMoment {
  static constexpr double kNone = std::numeric_limits<double>::infinity();
  Stamp stamp;
  double gap = kNone;       ///< to the shape itself
  double needed = 0;        ///< the stopping distance
  double shown = kNone;     ///< to the nearest ten returns of the shape, lower than the clearance
  double standing = kNone;  ///< of these, truly as high as obstacles
  double told = kNone;      ///< of these, as high by the front end's ground, too
  std::array<bool, kStopCallers> stops{};  ///< in the order of StopCaller
};

/// Why the advice was silent though ten returns were shown within the stopping distance.
enum class SilenceCause {
  kHeight,  ///< too few of them are as high as obstacles
  kGround,  ///< too few are by the front end's ground
  kDoubt    ///< doubted, or anything else
};
inline constexpr std::size_t kSilenceCauses = 3;

/// What a drive says of one shape, scene by scene.
class ObstacleVerdict {
 public:
  static constexpr double kBorder = 1;       ///< [m] beyond the stopping distance: neither
  static constexpr double kTolerance = 0.3;  ///< [m] a cell and a half: shown, but at its border

  explicit ObstacleVerdict(ShapeDemand demand) : demand_(demand) {}
  void add(const ObstacleMoment& moment);
  /// Nothing that comes may change it: every caller has called for what is shown and is to be
  /// stopped for.
  bool done() const;

  /// Scenes and stops of one caller.
  struct Calls {
    double called_at = ObstacleMoment::kNone;  ///< [m] gap at the first call within its border
    std::size_t silent = 0;  ///< scenes without a call, up to the first one, that had to have one
    StopCount stops;         ///< of use: those for nothing
  };
  const Calls& of(StopCaller caller) const { return calls_[static_cast<std::size_t>(caller)]; }
  bool shownWithin() const { return shown_within_ > 0; }    ///< ten returns, before it was too late
  bool missed(StopCaller caller) const;                     ///< shown, and never called for
  bool late(StopCaller caller, std::size_t allowed) const;  ///< called after more silent scenes

  double shown_at = ObstacleMoment::kNone;  ///< [m] gap at which ten returns were first shown
  double needed = 0;                        ///< [m] the stopping distance
  std::size_t scenes = 0;
  std::array<std::size_t, kSilenceCauses> silent_by_cause{};  ///< of the advice

 private:
  void addShown(const ObstacleMoment& moment);

  ShapeDemand demand_;
  std::size_t shown_within_ = 0;
  std::array<Calls, kStopCallers> calls_;
};

/// Nearest of distances [m] that has ten within half a meter from it on; infinity: none.
double nearestTen(std::vector<double> distances);

}  // namespace perception
