#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/packets/lidars/Beams.h"

namespace perception {

/// How the models differ. Byte 30 of a packet names the model, but for the Helios, whose packets
/// begin otherwise. The layouts of Helios and Bpearl are from memory of the maker's published
/// driver: they were not tried on a recording.
struct RoboSenseModel {
  const char* name;
  int id;
  std::size_t lasers;
  double firing;  ///< [us] from one firing of all lasers to the next
  double lens;    ///< [m] from the axis, by which the place of a return lies farther out
  double lowest = -25, highest = 15;  ///< [deg] of the elevations
  bool exactly = true;                ///< a unit's elevations reach from the one to the other
  double unit = 0.005;                ///< [m] of distances
  double lens_height = 0;             ///< [m] above the origin
  /// [us] after the firing, of a laser in the order of the packet.
  double laserTime(std::size_t laser) const;
};
extern const RoboSenseModel kRs16, kRs32, kHelios16, kHelios32, kBpearl;

/// RoboSenseModel::id of a Helios.
constexpr int kHeliosId = 0x106;
constexpr std::size_t kRoboSenseSize = 1248;  ///< [bytes] of both kinds of packets

/// A packet that says what the device is and how it is set (DIFOP).
bool isDifop(std::string_view payload);
/// The number of the model in a packet of returns (MSOP) of one of these layouts; empty: it is
/// none.
std::optional<int> robosenseModelIn(std::string_view payload);

/// The beams of the unit, of a DIFOP packet; empty: it does not have those of the model.
std::vector<BeamAngles> beamsOfDifop(std::string_view payload, const RoboSenseModel& model);
/// Beams of the RS-LiDAR-16, by its manual, in the order of the packet.
const std::vector<BeamAngles>& rs16Beams();
/// Of a file: a table of beams (Beams.h), or one DIFOP packet; empty path: the nominal ones, which
/// RS-LiDAR-16 alone has. Throws DataError.
std::vector<BeamAngles> robosenseBeams(const std::string& file, const RoboSenseModel& model);

}  // namespace perception
