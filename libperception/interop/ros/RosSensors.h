#pragma once
#include <optional>
#include <string>
#include <vector>

#include "libperception/interop/ros/RosDevices.h"
#include "libperception/interop/ros/RosMessages.h"
#include "libperception/measurement/frames/SensorFrame.h"

namespace perception::ros {

/// The cloud of a message, order and number of points kept, NaN points too. Needs the fields x, y,
/// z; used are intensity (or i, reflectivity), ring (or channel, line) and a time: t, offset_time
/// [ns] and time, time_offset [s] after the header's stamp; timestamp since 1970 (after the
/// earliest return's where the header has no stamp), or of a device without a date [s] since the
/// scan began, or since it was switched on (after the earliest return's). Intensities are divided
/// by `intensity_max`; 0: bytes by 255, others stay as they are. Throws std::runtime_error, also
/// where x, y, z are whole numbers, which have no known unit.
LidarCloud cloudOf(const PointCloud2& message, double intensity_max = 0);
/// A scan of Livox; `intensity_max`: 0 stands for 255. Times are after the header's stamp.
LidarCloud cloudOf(const LivoxScan& message, double intensity_max = 0);
/// A scan of one layer, in the plane z = 0: its ranges within range_min and range_max; others are
/// no returns. Throws std::runtime_error for angles that are not finite, and for intensities that
/// are not as many as ranges.
LidarCloud cloudOf(const LaserScan& message, double intensity_max = 0);
/// x, y, z, intensity as 32-bit floats, and ring and time_offset where the cloud has them. `data`:
/// holds the bytes of the message.
PointCloud2 messageOf(const LidarCloud& cloud, const Header& header, std::string& data);

/// Returns of a radar; range rates are multiplied by `rate_scale` (-1 where approaching is
/// positive, 0: there are none). Those that are not finite have no rate.
RadarReturns returnsOf(const RadarScan& message, double rate_scale = 1);
/// True for points with a range rate and no beam number: a radar's, not a Doppler lidar's.
bool isOfRadar(const PointCloud2& message);
/// The same of points: x, y, z, a range rate (doppler_velocity, doppler, range_rate,
/// radial_velocity, radial_speed, v_r, velocity) and, if there, amplitude (or rcs, power, snr,
/// intensity). Throws std::runtime_error.
RadarReturns returnsOf(const PointCloud2& message, double rate_scale = 1);
/// Objects of a radar's own tracker as returns: the place of each, and the part of its velocity
/// along the line of sight.
RadarReturns returnsOf(const RadarTracks& message, double rate_scale = 1);
RadarScan messageOf(const RadarReturns& radar, const Header& header);

/// Colors and gray values of 8 and 16 bits, Bayer patterns, and the usual forms of YUV. Of 16 bits
/// the higher 8. Throws std::runtime_error: another encoding, or fewer bytes than rows need.
Raster rasterOf(const Image& message);
/// Any format of OpenCV's imdecode(). Throws std::runtime_error.
Raster rasterOf(const CompressedImage& message);
/// A pinhole without distortion.
CameraInfo messageOf(const CameraModel& camera, const Header& header);
/// A pinhole; empty without a focal length. Of the rectified image where `rectified`.
std::optional<CameraModel> cameraOf(const CameraInfo& message, bool rectified);

}  // namespace perception::ros
