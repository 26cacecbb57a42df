#include "libperception/packets/Pcap.h"

#include <map>
#include <optional>
#include <tuple>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"
#include "libperception/packets/GzipFile.h"

namespace perception {
namespace {

constexpr std::size_t kFileHeader = 24, kRecordHeader = 16, kEthernet = 14, kUdpHeader = 8;
constexpr std::size_t kLargestRecord = 262144, kLargestDatagram = 65535;
constexpr std::size_t kOpenDatagrams = 64;  ///< bounds the memory of incomplete ones

struct Fragments {
  std::map<std::size_t, std::string> parts;  ///< by offset
  std::optional<std::size_t> size;           ///< known with the last fragment
};

/// The datagram if it has no hole.
std::optional<std::string> assembled(const Fragments& fragments) {
  if (!fragments.size) return std::nullopt;
  std::string whole;
  for (const auto& [offset, part] : fragments.parts) {
    if (offset != whole.size()) return std::nullopt;
    whole += part;
  }
  if (whole.size() != *fragments.size) return std::nullopt;
  return whole;
}

class PcapParser {
 public:
  PcapParser(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  PcapContents parse() {
    readHeader();
    std::size_t at = kFileHeader;
    while (at < bytes_.size()) {
      ++record_;
      if (bytes_.size() - at < kRecordHeader) return torn();
      const std::size_t size = number(at + 8);
      if (size > kLargestRecord) {
        warn("says " + std::to_string(size) + " bytes; the rest is not read");
        break;
      }
      if (bytes_.size() - at - kRecordHeader < size) return torn();
      stamp_ = static_cast<std::int64_t>(number(at)) * 1000000000 +
               static_cast<std::int64_t>(number(at + 4)) * (nanoseconds_ ? 1 : 1000);
      if (number(at + 12) > size) {
        warn("was cut when it was captured");
      } else {
        readFrame(bytes_.substr(at + kRecordHeader, size));
      }
      at += kRecordHeader + size;
    }
    return finish();
  }

 private:
  void readHeader() {
    if (bytes_.size() < kFileHeader) throw DataError(name_ + ": no pcap: shorter than its header");
    for (const bool swapped : {false, true}) {
      swapped_ = swapped;
      const std::uint64_t magic = number(0);
      nanoseconds_ = magic == 0xA1B23C4D;
      if (!nanoseconds_ && magic != 0xA1B2C3D4) continue;
      if (number(20) == 1) return;
      throw DataError(name_ + ": byte 20: link type " + std::to_string(number(20)) +
                      ", expected 1 (Ethernet)");
    }
    throw DataError(name_ + ": byte 0: no pcap (magic number A1B2C3D4 or A1B23C4D expected)");
  }

  std::uint64_t number(std::size_t at) const {
    return swapped_ ? bigEndian(bytes_, at, 4) : littleEndian(bytes_, at, 4);
  }

  void warn(const std::string& what) {
    contents_.warnings.push_back(name_ + ": record " + std::to_string(record_) + " " + what);
  }

  PcapContents torn() {
    warn("is torn: the file ends in it");
    return finish();
  }

  PcapContents finish() {
    if (!open_.empty()) {
      contents_.warnings.push_back(name_ + ": " + std::to_string(open_.size()) +
                                   " datagrams lack fragments");
    }
    return std::move(contents_);
  }

  void readFrame(std::string_view frame) {
    std::size_t at = kEthernet - 2;
    while (frame.size() >= at + 6 &&
           (bigEndian(frame, at, 2) == 0x8100 || bigEndian(frame, at, 2) == 0x88A8)) {
      at += 4;
    }
    if (frame.size() < at + 2) return warn("is shorter than an Ethernet header");
    if (bigEndian(frame, at, 2) == 0x0800) readIp(frame.substr(at + 2));
  }

  void readIp(std::string_view ip) {
    if (ip.size() < 20 || bigEndian(ip, 0, 1) >> 4 != 4) return warn("has no whole IPv4 header");
    if (bigEndian(ip, 9, 1) != 17) return;
    const std::size_t header = (bigEndian(ip, 0, 1) & 15) * 4, stated = bigEndian(ip, 2, 2);
    if (header < 20 || stated < header || stated > ip.size()) {
      return warn("has an IPv4 length that does not fit");
    }
    const std::string body(ip.substr(header, stated - header));
    const std::size_t flags = bigEndian(ip, 6, 2);
    const std::size_t offset = (flags & 0x1FFF) * 8;
    const bool more = flags & 0x2000;
    const auto source = static_cast<std::uint32_t>(bigEndian(ip, 12, 4));
    if (offset == 0 && !more) return readUdp(body, source);
    const Key key{source, bigEndian(ip, 16, 4), bigEndian(ip, 4, 2)};
    addFragment(key, offset, more, body);
  }

  using Key = std::tuple<std::uint32_t, std::uint64_t, std::uint64_t>;
  void addFragment(const Key& key, std::size_t offset, bool more, const std::string& body) {
    if (offset + body.size() > kLargestDatagram) return warn("is a fragment beyond 65535 bytes");
    if (open_.count(key) == 0 && open_.size() >= kOpenDatagrams) {
      warn("leaves out an incomplete datagram: too many are open");
      open_.erase(open_.begin());
    }
    Fragments& fragments = open_[key];
    fragments.parts[offset] = body;
    if (!more) fragments.size = offset + body.size();
    if (const auto whole = assembled(fragments)) {
      open_.erase(key);
      readUdp(*whole, std::get<0>(key));
    }
  }

  void readUdp(std::string_view udp, std::uint32_t source) {
    if (udp.size() < kUdpHeader) return warn("is shorter than a UDP header");
    const std::size_t stated = bigEndian(udp, 4, 2);
    if (stated < kUdpHeader || stated > udp.size())
      return warn("has a UDP length that does not fit");
    contents_.packets.push_back({stamp_, source, static_cast<std::uint16_t>(bigEndian(udp, 0, 2)),
                                 static_cast<std::uint16_t>(bigEndian(udp, 2, 2)),
                                 std::string(udp.substr(kUdpHeader, stated - kUdpHeader))});
  }

  std::string_view bytes_;
  std::string name_;
  PcapContents contents_;
  std::map<Key, Fragments> open_;
  bool swapped_ = false, nanoseconds_ = false;
  std::size_t record_ = 0;
  std::int64_t stamp_ = 0;
};

}  // namespace

PcapContents parsePcap(std::string_view bytes, const std::string& name) {
  return PcapParser(bytes, name).parse();
}

PcapContents readPcap(const std::string& path) {
  return parsePcap(readPossiblyGzipped(path), path);
}

}  // namespace perception
