#pragma once
#include <string_view>

#include "libperception/packets/LidarReturn.h"

namespace perception {

/// Decodes a data packet of a Velodyne VLP-16 or VLP-32C (1206 bytes; the model is in the packet;
/// azimuths interpolated by the time of each firing, without vertical offsets of the lasers). Of
/// equal dual returns the first alone. Source: the manuals of the sensors.
/// Throws DataError if the size, a block's flag, the model or the azimuth is not one of these.
LidarPacket decodeVelodyne(std::string_view payload);

}  // namespace perception
