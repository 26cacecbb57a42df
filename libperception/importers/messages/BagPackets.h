#pragma once
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/importers/messages/BagTypes.h"
#include "libperception/measurement/frames/SensorFrame.h"
#include "libperception/packets/FrameAssembler.h"

namespace perception {

/// Scans from the packets in one topic's messages.
class BagPackets {
 public:
  /// Takes each scan, with its stamp and the frame of the messages as header.
  using Take = std::function<void(const ros::Header&, SensorFrame&&)>;

  /// `metadata`: of the device, for those that have it (BagType::device_files).
  BagPackets(const BagType& type, std::string label, std::string metadata, Take take);

  /// Throws std::runtime_error: the message, or no kind of device sends such packets.
  void add(const BagMessage& message);
  void finish();
  /// Packets that are damaged or missing, with the topic's label.
  std::vector<std::string> warnings() const;

 private:
  void start(std::string_view packet);

  const BagType& type_;
  std::string label_, metadata_;
  Take take_;
  std::string frame_id_;
  std::unique_ptr<FrameAssembler> assembler_;  ///< none before the first packet of a known device
  std::size_t surplus_ = 0;                    ///< [bytes] behind each packet
};

}  // namespace perception
