#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "libperception/grid/way/FreeDistance.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/scene/Scene.h"

namespace perception::ros {

// What ROS's own tools show without a plugin: marks, a map, the state of parts. Only written.

/// visualization_msgs/Marker of ROS 2 (humble and later).
struct Marker {
  enum Type : std::int32_t { kArrow = 0, kCube = 1, kText = 9 };
  enum Action : std::int32_t { kAdd = 0, kDeleteAll = 3 };
  Header header;
  std::string ns;
  std::int32_t id = 0, type = kCube, action = kAdd;
  Pose pose;
  std::array<double, 3> scale{1, 1, 1};  ///< [m]
  std::array<float, 4> color{};          ///< red, green, blue, alpha
  std::string text;
};
template <class Wire>
void fields(Wire& w, Marker& m) {
  static_assert(!Wire::kReads, "marks are only written");
  w(m.header), w(m.ns), w(m.id), w(m.type), w(m.action), w(m.pose), w(m.scale), w(m.color);
  w(std::array<std::uint32_t, 2>{}), w(std::uint8_t{0});  // stays; not locked to its frame
  w(std::uint32_t{0}), w(std::uint32_t{0});               // no points, no colors
  w(std::string()), w(Header{}), w(std::string()), w(std::string_view());  // no texture
  w(std::uint32_t{0}), w(m.text);                                          // no places in a texture
  w(std::string()), w(std::string()), w(std::string_view()), w(std::uint8_t{0});  // no mesh
}

struct MarkerArray {
  std::vector<Marker> markers;
  auto members() { return std::tie(markers); }
};

struct OccupancyGrid {
  Header header;
  float resolution = 0;  ///< [m] edge of a cell
  std::uint32_t width = 0, height = 0;
  Pose origin;            ///< of the corner of the first cell
  std::string_view data;  ///< rows along x, an int8 a cell: 0 free to 100 occupied, -1 not known
  auto members() { return std::tie(header, header.stamp, resolution, width, height, origin, data); }
};

struct KeyValue {
  std::string key, value;
  auto members() { return std::tie(key, value); }
};

/// diagnostic_msgs/DiagnosticStatus.
struct DiagnosticStatus {
  enum Level : std::uint8_t { kOk = 0, kWarn = 1, kError = 2, kStale = 3 };
  std::uint8_t level = kOk;
  std::string name, message, hardware_id;
  std::vector<KeyValue> values;
  auto members() { return std::tie(level, name, message, hardware_id, values); }
};

struct DiagnosticArray {
  Header header;
  std::vector<DiagnosticStatus> status;
  auto members() { return std::tie(header, status); }
};

/// std_msgs/Bool and Float64.
template <class Value>
struct Plain {
  Value value{};
  auto members() { return std::tie(value); }
};

/// A box with a text an object and an arrow where it moves, behind a mark that removes all before.
/// The more probable the object, the less transparent.
MarkerArray marksOf(const Scene& scene, const std::string& frame,
                    const std::vector<std::string>& class_names);

/// The cells of the safety grid seen from above, within `reach` [m] of the vehicle: the most
/// occupied of each column. `data` holds the bytes of the message.
OccupancyGrid mapOf(const Scene& scene, const std::string& frame,
                    const std::vector<GridCell>& cells, double resolution, double reach,
                    std::string& data);

}  // namespace perception::ros
