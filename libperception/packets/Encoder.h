#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/measurement/SensorFrame.h"

namespace perception {

/// A packet of a simulated device.
struct TimedPacket {
  double after = 0;  ///< [s] the frame's stamp, at which it is sent
  std::string payload;
};

/// Writes what a device would send: frames to packets that its decoder reads. Lidar returns go to
/// the device's nearest beam and firing, the nearest one of several; the rest of what a real device
/// sends (noise floor, status messages) is not there.
class PacketEncoder {
 public:
  virtual ~PacketEncoder() = default;
  /// `frame.stamp`: of the device's clock; `period`: to the next frame [s], in which a lidar turns
  /// once. Throws DataError if the frame's data is not what the device measures.
  virtual std::vector<TimedPacket> encode(const SensorFrame& frame, double period) = 0;
  /// The device is switched on anew: numbers begin where they do.
  virtual void restart() = 0;

 protected:
  static const LidarCloud& cloudOf(const SensorFrame& frame);
  static const RadarReturns& returnsOf(const SensorFrame& frame);
};

/// `file`: the model, VLP-16 (also if empty) or VLP-32C; throws ConfigError for another.
std::unique_ptr<PacketEncoder> makeVelodyneEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makePandar40pEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeXt32Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeOusterEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeIbeoEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeEsrEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeArs548Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeSrr520Encoder(const std::string& file);

}  // namespace perception
