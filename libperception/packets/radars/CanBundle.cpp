#include "libperception/packets/radars/CanBundle.h"

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"

namespace perception {
namespace {

constexpr std::size_t kId = 4, kClassicData = 8, kFdData = 64;
constexpr std::uint32_t kError = 0x20000000, kExtended = 0x1FFFFFFF, kRemote = 0x40000000;
constexpr std::size_t kBundleHeader = 5;
constexpr std::uint64_t kFd = 0x80;

[[noreturn]] void refuseBundle(std::size_t at, const std::string& what) {
  throw DataError("CAN datagram: byte " + std::to_string(at) + ": " + what);
}

}  // namespace

std::string canMessage(std::uint32_t id, std::string_view data) {
  std::string message(kId, '\0');
  putBig(message, 0, id, kId);
  message += data;
  return message;
}

std::uint32_t canId(std::string_view message) {
  return static_cast<std::uint32_t>(bigEndian(message, 0, kId));
}

CanBundle parseCanBundle(std::string_view datagram) {
  if (datagram.size() < kBundleHeader)
    refuseBundle(0, std::to_string(datagram.size()) + " bytes, shorter than the header");
  if (littleEndian(datagram, 0, 1) != 2) refuseBundle(0, "version 2 expected");
  if (littleEndian(datagram, 1, 1) != 0) refuseBundle(1, "operation 0 (frames) expected");
  CanBundle bundle;
  bundle.number = static_cast<std::uint8_t>(datagram[2]);
  const auto count = bigEndian(datagram, 3, 2);
  std::size_t at = kBundleHeader;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (datagram.size() < at + kId + 1) refuseBundle(at, "frame " + std::to_string(i) + " is cut");
    const auto id = static_cast<std::uint32_t>(bigEndian(datagram, at, kId));
    const auto length = bigEndian(datagram, at + kId, 1);
    const bool fd = (length & kFd) != 0;
    const std::size_t size = length & ~kFd;
    at += kId + (fd ? 2 : 1);
    if (size > (fd ? kFdData : kClassicData)) refuseBundle(at, std::to_string(size) + " bytes");
    if ((id & kRemote) != 0) continue;  // has no data
    if (datagram.size() < at + size) refuseBundle(at, "frame " + std::to_string(i) + " is cut");
    if ((id & kError) == 0)
      bundle.messages.push_back(canMessage(id & kExtended, datagram.substr(at, size)));
    at += size;
  }
  return bundle;
}

std::string canBundle(const CanBundle& bundle) {
  std::string bytes(kBundleHeader, '\0');
  bytes[0] = 2;
  bytes[2] = static_cast<char>(bundle.number);
  putBig(bytes, 3, bundle.messages.size(), 2);
  for (const std::string& message : bundle.messages) {
    const std::size_t size = message.size() - kId;
    bytes += message.substr(0, kId);
    bytes += static_cast<char>(size > kClassicData ? size | kFd : size);
    if (size > kClassicData) bytes += '\0';  // flags of CAN FD
    bytes += message.substr(kId);
  }
  return bytes;
}

}  // namespace perception
