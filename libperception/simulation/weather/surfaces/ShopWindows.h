#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "libperception/simulation/SimulatedWeather.h"

namespace perception {

struct ObjectParams;

/// Panes of glass in the ground floors of houses (boxes of 4 m and more; method.md 9.9). They are
/// there in any weather: lidar beams mostly pass through and may return from what is mirrored,
/// image detectors find the mirror images of road users. What stands between an object and its
/// window, or between that and the camera, is not regarded.
class ShopWindows final : public SimulatedWeather {
 public:
  /// `share` [0, 1] of glass in the ground floors; which panes are of glass depends on `seed`.
  ShopWindows(double share, std::uint64_t seed);

  using SimulatedWeather::alter;
  /// The world must live until the last alter() after it.
  void advance(const World& world, const SensorParams& sensor, double t) override;
  void alter(const SensorParams& sensor, LidarPulse& pulse, Rng& rng) const override;
  void alter(const SensorParams& sensor, SensorFrame& frame, Rng& rng) const override;
  bool actsOnPulses() const override { return true; }

 private:
  /// A wall of a house in the house's frame: the plane `axis` = `offset`.
  struct Front {
    std::size_t house = 0;  // index in the scenario
    int axis = 0;           // 0: x, 1: y
    double offset = 0;      // [m], its sign is the side that is outside
    double half = 0;        // [m] of its length
    Pose3 T_world_house = Pose3::Identity();
  };
  /// How an object is seen in a front.
  struct Image {
    double path = 0;         // [m] camera, glass, object
    double reflectance = 0;  // of the glass
  };
  bool isGlass(const Front& front, const Vector3& on_front) const;
  std::optional<Image> imageIn(const Front& front, const Vector3& camera,
                               const Vector3& object) const;
  void addBox(const SensorParams& sensor, const Front& front, std::size_t object,
              const Image& image, const Pose3& T_world_camera, ObjectDetections& detections,
              Rng& rng) const;

  double share_;
  std::uint64_t seed_;
  const World* world_ = nullptr;
  double t_ = 0;
  std::vector<Front> fronts_;
};

}  // namespace perception
