#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace perception {

/// A detection of a Continental ARS548, polar in the sensor's frame.
struct Ars548Detection {
  float azimuth = 0, azimuth_sd = 0;        ///< [rad], left positive
  float elevation = 0, elevation_sd = 0;    ///< [rad], up positive
  float range = 0, range_sd = 0;            ///< [m]
  float range_rate = 0, range_rate_sd = 0;  ///< [m/s], away positive
  int rcs = 0;                              ///< [dBm2]
  std::uint8_t invalid = 0;                 ///< bits as sent; 0: all of it is valid
};

/// An object of its internal tracker, in the vehicle's frame.
struct Ars548Object {
  std::uint32_t id = 0;
  float x = 0, y = 0, z = 0;  ///< reference point [m]
  float yaw = 0;              ///< [rad]
  float vx = 0, vy = 0;       ///< relative velocity [m/s]
  float length = 0, width = 0;
};

/// One message; of the two lists only that of the message's method is filled.
struct Ars548Message {
  std::int64_t stamp_ns = 0;  ///< the sensor's [ns] since 1970
  bool synchronized = false;  ///< whether the stamp can be used
  std::vector<Ars548Detection> detections;
  std::vector<Ars548Object> objects;
};

/// Decodes a SOME/IP message of detections (method 336) or 50 or 200 objects (method 329).
/// Throws DataError if the method, the size or a count is wrong.
Ars548Message decodeArs548(std::string_view payload);

}  // namespace perception
