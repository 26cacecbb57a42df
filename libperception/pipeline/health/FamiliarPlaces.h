#pragma once
#include <functional>
#include <map>
#include <utility>
#include <vector>

#include "libperception/measurement/Measurement.h"

namespace perception {

/// Places at which a radar saw something standing that is no object: walls, posts, trees. A radar
/// that no longer reports any of them, while the vehicle has hardly moved and a lidar still sees
/// something there, is likely to be blind (method.md 9.10).
class FamiliarPlaces {
 public:
  struct View {
    double fov = 0, range_max = 0;  ///< [rad], [m]
  };
  using StillThere = std::function<bool(const Vector2&)>;

  /// A scan; `silent`: the radar reported nothing; `tracked`: places of objects, world, which
  /// answer for themselves; `stillThere`: whether a lidar sees something at a place now.
  void add(const MeasurementScan& scan, bool silent, const View& view,
           const std::vector<Vector2>& tracked, const StillThere& stillThere);
  /// Log probability that a healthy radar has seen none of them since its last measurement.
  double logMissed() const { return log_missed_; }

 private:
  struct Place {
    Vector2 at = Vector2::Zero(), seen_from = Vector2::Zero();
    double hits = 0, looks = 0;  ///< remembered
    bool hit = false;            ///< in this scan
  };
  using Cell = std::pair<long, long>;
  static Cell cellOf(const Vector2& place);
  void forget(Stamp now);
  void see(const Vector2& place, const Vector2& from);
  void miss(const MeasurementScan& scan, const View& view, const StillThere& stillThere);

  std::map<Cell, Place> places_;
  std::optional<Stamp> last_;
  double log_missed_ = 0;
};

}  // namespace perception
