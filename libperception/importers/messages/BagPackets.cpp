#include "libperception/importers/messages/BagPackets.h"

#include <fmt/format.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/packets/Decoder.h"

namespace perception {
namespace {

/// A device's metadata as a file in memory, for as long as a decoder is made of it.
class MetadataFile {
 public:
  explicit MetadataFile(const std::string& text) : file_(::memfd_create("metadata", MFD_CLOEXEC)) {
    if (file_ < 0 ||
        ::write(file_, text.data(), text.size()) != static_cast<::ssize_t>(text.size())) {
      if (file_ >= 0) ::close(file_);
      throw std::runtime_error("no memory for the metadata of a device");
    }
  }
  ~MetadataFile() { ::close(file_); }
  MetadataFile(const MetadataFile&) = delete;
  MetadataFile& operator=(const MetadataFile&) = delete;
  std::string path() const { return "/proc/self/fd/" + std::to_string(file_); }

 private:
  int file_;
};

/// Ouster's driver of ROS 1 sends one byte more than the device.
constexpr std::size_t kMostSurplus = 1;

}  // namespace

BagPackets::BagPackets(const BagType& type, std::string label, std::string metadata, Take take)
    : type_(type),
      label_(std::move(label)),
      metadata_(std::move(metadata)),
      take_(std::move(take)) {}

/// Chooses the device whose decoder takes the packet; none for those of others on a bus.
void BagPackets::start(std::string_view packet) {
  std::string refused;
  for (const std::string name : type_.devices) {
    const DeviceKind& kind = deviceKind(name);
    if (kind.needs_file && metadata_.empty())
      throw std::runtime_error(
          fmt::format("packets of {} without its metadata: no topic of std_msgs/String whose name "
                      "holds \"metadata\"",
                      kind.description));
    const MetadataFile file(metadata_);
    const std::string path = metadata_.empty() ? "" : file.path();
    for (std::size_t surplus = 0; surplus <= kMostSurplus && surplus < packet.size(); ++surplus) {
      try {
        const auto decoder = kind.make(path);
        if (!decoder->takes(packet)) break;
        decoder->decode(packet.substr(0, packet.size() - surplus));
      } catch (const DataError& e) {
        refused += fmt::format("{}{}: {}", refused.empty() ? "" : "; ", kind.name, e.what());
        continue;
      }
      surplus_ = surplus;
      assembler_ = std::make_unique<FrameAssembler>(
          kind, path, label_, Pose3::Identity(), [this](SensorFrame&& scan) {
            const ros::Header header{scan.stamp, frame_id_};
            take_(header, std::move(scan));
          });
      return;
    }
  }
  if (!refused.empty()) throw std::runtime_error("packets of no known device: " + refused);
}

void BagPackets::add(const BagMessage& message) {
  std::vector<BagPacket> packets;
  frame_id_ = type_.unpack(message, packets).frame_id;
  for (const BagPacket& packet : packets) {
    if (!assembler_) start(packet.bytes);
    if (!assembler_) continue;  // of others on a bus
    assembler_->add(
        packet.bytes.substr(0, packet.bytes.size() - std::min(surplus_, packet.bytes.size())),
        packet.stamp.ns > 0 ? packet.stamp : message.stamp);
  }
}

void BagPackets::finish() {
  if (assembler_) assembler_->finish();
}

std::vector<std::string> BagPackets::warnings() const {
  return assembler_ ? assembler_->warnings() : std::vector<std::string>();
}

}  // namespace perception
