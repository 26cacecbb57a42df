#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/measurement/frames/SensorFrame.h"

namespace perception {

/// A packet of a simulated device.
struct TimedPacket {
  double after = 0;  ///< [s] the frame's stamp, at which it is sent
  std::string payload;
};

/// Writes what a device would send: turns frames into packets that its decoder reads. Each lidar
/// return goes to the device's nearest beam and firing; of several returns there the nearest one is
/// sent. A real device also sends a noise floor and status messages; these are left out.
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
/// Without packets of the device (DIFOP). `file`: beams of the unit; of RS-LiDAR-32 needed.
std::unique_ptr<PacketEncoder> makeRs16Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeRs32Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeHelios16Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeHelios32Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeBpearlEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeOusterEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeIbeoEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeEsrEncoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeArs408Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeArs548Encoder(const std::string& file);
std::unique_ptr<PacketEncoder> makeSrr520Encoder(const std::string& file);

}  // namespace perception
