#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"
#include "libperception/measurement/Modality.h"
#include "libperception/measurement/frames/EarlierScan.h"
#include "libperception/measurement/frames/PhantomCauses.h"

namespace perception {

/// Standard deviations of the ego pose at one instant. They enlarge R of every measurement
/// (method.md 1.3).
struct PoseUncertainty {
  double sigma_xy = 0.05;             ///< [m]
  double sigma_yaw = radians(0.2);    ///< [rad]
  double sigma_pitch = radians(0.3);  ///< [rad]
};

/// The vehicle at one instant.
struct EgoState {
  Stamp stamp;
  Pose3 T_world_ego = Pose3::Identity();
  Vector2 velocity = Vector2::Zero();  ///< [m/s] of the ego origin, world
  double yaw_rate = 0;                 ///< [rad/s]
  PoseUncertainty uncertainty;
};

/// The ground around the vehicle as height over the ego frame's x and y: z = a x + b y + c.
struct GroundPlane {
  double a = 0, b = 0, c = 0;  ///< slope [-], slope [-], height [m], ego frame
  double sigma = 0.1;          ///< [m] spread of ground returns about it
  bool measured = false;       ///< false: the flat default z = 0
  double heightAt(double x, double y) const { return a * x + b * y + c; }
};

/// Classification of a return by the sensor itself, if it gives one (Ibeo).
enum class PointLabel : std::uint8_t {
  kUnknown = 0,
  kObject = 1,
  kRain = 2,
  kGround = 3,
  kDirt = 4
};

/// One lidar scan, points in the sensor frame. x, y, z have the same size; the other vectors have
/// that size or are empty.
struct LidarCloud {
  std::vector<float> x, y, z;       ///< [m]
  std::vector<float> intensity;     ///< [0, 1]
  std::vector<std::uint16_t> ring;  ///< beam number, 0 = lowest
  std::vector<float> time_offset;   ///< [s] after the frame's stamp
  std::vector<std::uint8_t> echo;   ///< 0 = first return of its pulse
  std::vector<float> pulse_width;   ///< [m]
  std::vector<std::uint8_t> label;  ///< PointLabel
  std::vector<float> trust;  ///< [0, 1] P(the return is of a surface), from PointTrust; 0: a mirror
                             ///< image in a wet road
  double max_range = 0;      ///< [m] of the instrument; 0 = unknown

  std::size_t size() const { return x.size(); }
};

/// A camera without distortion. Its sensor frame is optical: x right, y down, z forward.
/// Equirectangular (a spherical panorama): column u looks at azimuth (u - cx) / fx to the right of
/// z, row v at (v - cy) / fy below the horizon [rad]; fx = width / 2 pi for the full circle.
struct CameraModel {
  enum class Projection : std::uint8_t { kPinhole, kEquirectangular };
  int width = 0, height = 0;              ///< [px]
  double fx = 0, fy = 0, cx = 0, cy = 0;  ///< [px]; equirectangular: fx, fy in [px/rad]
  Projection projection = Projection::kPinhole;
};

/// Pixels, rows from the top, interleaved blue, green, red (or gray alone).
struct Raster {
  int width = 0, height = 0, channels = 3;
  std::vector<std::uint8_t> pixels;
};

/// An image of the log. Loaded on demand: most logs store images in external files.
struct CameraImage {
  CameraModel camera;                           ///< width and height may be 0 until it is loaded
  std::string source;                           ///< file or "in the log", for messages
  std::function<std::optional<Raster>()> load;  ///< empty result: no such image
};

/// One target or point of a radar, in the sensor frame (x forward, y left).
struct RadarReturn {
  double range = 0;       ///< [m]
  double bearing = 0;     ///< [rad] counter-clockwise off the forward axis
  double range_rate = 0;  ///< [m/s] relative to the moving sensor, > 0 moves away; see has_rate
  bool has_rate = true;
  double amplitude = 0;             ///< [dB] radar cross section or signal, in the unit's own scale
  std::optional<double> elevation;  ///< [rad] above the sensor's horizontal plane
  std::int32_t id = -1;             ///< the unit's own track number; -1 = none
};

/// What one radar unit reported at one instant.
struct RadarReturns {
  std::vector<RadarReturn> returns;
  double max_range = 0;  ///< [m] of the instrument; 0 = unknown
};

/// One object found by an external detector: an image box, a 3D box, or both.
struct ObjectDetection {
  struct ImageBox {
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;  ///< [px] left, top, right, bottom
  };
  struct SpaceBox {
    Vector3 bottom_center = Vector3::Zero();   ///< [m] sensor frame (x forward, y left, z up)
    double yaw = 0;                            ///< [rad] of the length axis, sensor frame
    double length = 0, width = 0, height = 0;  ///< [m]
  };
  std::string label;  ///< the detector's class name
  double score = 0;   ///< in the detector's own unit
  std::vector<std::pair<std::string, double>>
      class_scores;  ///< of detectors that score several classes
  std::optional<ImageBox> image_box;
  std::optional<SpaceBox> space_box;
  std::optional<double>
      heading;  ///< [rad] KITTI's alpha: observation angle of the object, in (-pi, pi]
};

/// All detections of one detector at one instant. `camera` refers to the image boxes.
struct ObjectDetections {
  CameraModel camera;
  std::vector<ObjectDetection> objects;
  std::optional<Pose3>
      T_ego_camera;  ///< optical frame of the image boxes; empty: it is the sensor frame itself
};

/// One decoded observation of one sensor, with the pose of vehicle and sensor and the ground at
/// that time.
struct SensorFrame {
  std::string sensor;  ///< label, as in [sensor.LABEL]
  Stamp stamp;
  std::int64_t frame = -1;  ///< the log's own frame number; -1 = none
  EgoState ego;
  Pose3 T_ego_sensor = Pose3::Identity();
  GroundPlane ground;
  PhantomCauses causes;                       ///< of phantoms at this instant; by default none
  std::shared_ptr<const EarlierScan> before;  ///< of a lidar; null: none
  std::variant<LidarCloud, ObjectDetections, RadarReturns, CameraImage> data;

  Pose3 T_world_sensor() const { return ego.T_world_ego * T_ego_sensor; }
};

}  // namespace perception
