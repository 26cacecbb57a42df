#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// Payload of a UDP datagram, IPv4 fragments put together.
struct UdpPacket {
  std::int64_t stamp_ns = 0;  ///< reception [ns] since 1970
  std::uint32_t source = 0;   ///< IPv4 address
  std::uint16_t source_port = 0;
  std::uint16_t port = 0;  ///< of the destination
  std::string payload;
};

/// A capture as far as it could be read.
struct PcapContents {
  std::vector<UdpPacket> packets;
  std::vector<std::string> warnings;  ///< one for each damaged record, with its number
};

/// UDP packets of a pcap file (Ethernet, either byte order, us or ns). A damaged record costs that
/// record and gives a warning; a torn end ends the capture with one. Other protocols are skipped.
/// `name`: for messages. Throws DataError if the bytes are no pcap of Ethernet.
PcapContents parsePcap(std::string_view bytes, const std::string& name);

/// The same of a file; throws DataError if it cannot be read.
PcapContents readPcap(const std::string& path);

}  // namespace perception
