#pragma once
#include <array>
#include <cstdint>
#include <deque>
#include <optional>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/Modality.h"

namespace perception {

/// A vehicle at an instant.
struct VehicleFootprint {
  Stamp stamp;
  Vector2 center = Vector2::Zero();        ///< [m] world
  Vector2 along = Vector2::UnitX();        ///< unit vector of its velocity, world
  double speed = 0;                        ///< [m/s]
  double half_length = 0, half_width = 0;  ///< [m]
  double advanced = 0;  ///< [m] driven since its footprint before: the way between was swept, too
  double came = 0;      ///< [m] that it must have driven before its first footprint
};

/// The places that vehicles have just left, where spray, blown snow and exhaust hang: a cluster
/// there may be seen in several scans at one place and yet be no object. No solid object that
/// stands was there while the vehicle passed (method.md 5.19).
class WakeMap {
 public:
  /// In order of time; forgets what is older than the life of a wake.
  void add(const VehicleFootprint& vehicle);
  /// Forgets what is older than the life of a wake.
  void advance(Stamp now);
  bool empty() const { return vehicles_.empty(); }

  /// [s] since a vehicle left the place [m, world]; empty: it is in no wake.
  std::optional<double> age(const Vector2& place, Stamp now) const;
  /// What vehicles did at a place.
  struct Past {
    bool has_left = false;  ///< one was there and is there no more
    bool came_by = false;   ///< one must have come by before it was first seen, and none was seen
                            ///< there since
  };
  Past pastOf(const Vector2& place, Stamp now) const;  ///< `place`: [m, world]
  bool hasLeft(const Vector2& place, Stamp now) const { return pastOf(place, now).has_left; }
  bool cameBy(const Vector2& place, Stamp now) const { return pastOf(place, now).came_by; }
  /// [m^2] of all wakes; where two overlap, of both.
  double area(Stamp now) const;

  /// Expected clusters of phantoms per scan and area of a wake that are taken for objects, over the
  /// expected false measurements per scan and area. 0: none.
  double density = 0;
  /// P(a phantom that has been seen at a place is seen there again, `age` seconds after the
  /// vehicle).
  static double detection(Modality modality, double age);

 private:
  static constexpr int kCells = 64;                 ///< along each axis, after which they repeat
  using Cells = std::array<std::uint64_t, kCells>;  ///< a row a word

  /// Marks the cells that the vehicle's wake may reach in its life.
  void mark(const VehicleFootprint& vehicle);
  static void markAround(const Vector2& place, double reach, Cells& cells);
  static bool isMarked(const Vector2& place, const Cells& cells);

  std::deque<VehicleFootprint> vehicles_;
  Cells reached_{};  ///< elsewhere is no wake
  Cells came_by_{};  ///< elsewhere no vehicle has come by
};

}  // namespace perception
