#include "libperception/packets/radars/CanBundle.h"

#include <algorithm>
#include <cctype>

#include "libperception/core/Error.h"
#include "libperception/packets/Bytes.h"

namespace perception {
namespace {

constexpr std::size_t kId = 4, kClassicData = 8, kFdData = 64;
constexpr std::uint32_t kError = 0x20000000, kExtended = 0x1FFFFFFF, kRemote = 0x40000000;
constexpr std::size_t kBundleHeader = 5;
constexpr std::uint64_t kFd = 0x80;

[[noreturn]] void refuseLine(std::string_view line, const std::string& what) {
  throw DataError("candump: '" + std::string(line.substr(0, 100)) + "': " + what);
}

[[noreturn]] void refuseBundle(std::size_t at, const std::string& what) {
  throw DataError("CAN datagram: byte " + std::to_string(at) + ": " + what);
}

int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// Up to nine digits behind the point.
std::int64_t stampOf(std::string_view line, std::string_view text) {
  std::int64_t seconds = 0, nanoseconds = 0, unit = 100000000;
  bool behind = false;
  for (const char c : text) {
    if (c == '.' && !behind) {
      behind = true;
    } else if (c < '0' || c > '9' || seconds > 10000000000) {
      refuseLine(line, "no stamp in seconds");
    } else if (behind) {
      nanoseconds += (c - '0') * unit;
      unit /= 10;
    } else {
      seconds = seconds * 10 + (c - '0');
    }
  }
  if (seconds > 9000000000) refuseLine(line, "no stamp in seconds");
  return seconds * 1000000000 + nanoseconds;
}

std::string dataOf(std::string_view line, std::string_view hex, std::size_t most) {
  std::string data;
  for (std::size_t i = 0; i < hex.size();) {
    if (hex[i] == '.' && !data.empty()) {
      ++i;
      continue;
    }
    if (hex[i] == '_' && data.size() == kClassicData) break;  // the length's raw code
    if (i + 1 >= hex.size() || digit(hex[i]) < 0 || digit(hex[i + 1]) < 0)
      refuseLine(line, "two hexadecimal digits a byte expected");
    data += static_cast<char>(digit(hex[i]) * 16 + digit(hex[i + 1]));
    i += 2;
  }
  if (data.size() > most) refuseLine(line, std::to_string(data.size()) + " bytes of data");
  return data;
}

/// The words of a line, up to three.
std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size() && words.size() < 3;) {
    const std::size_t from = line.find_first_not_of(" \t\r\n", at);
    if (from == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t\r\n", from), line.size());
    words.push_back(line.substr(from, at - from));
  }
  return words;
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

std::optional<CandumpLine> parseCandump(std::string_view line) {
  const auto words = wordsOf(line);
  if (words.empty() || words[0][0] == '#') return std::nullopt;
  if (words.size() < 3 || words[0].size() < 3 || words[0].front() != '(' || words[0].back() != ')')
    refuseLine(line, "'(SECONDS) INTERFACE ID#DATA' expected");
  CandumpLine out;
  out.stamp_ns = stampOf(line, words[0].substr(1, words[0].size() - 2));
  out.interface = words[1];
  const std::string_view frame = words[2];
  const std::size_t mark = frame.find('#');
  if (mark != 3 && mark != 8) refuseLine(line, "an identifier of 3 or 8 digits and # expected");
  std::uint32_t id = 0;
  for (const char c : frame.substr(0, mark)) {
    if (digit(c) < 0) refuseLine(line, "an identifier of hexadecimal digits expected");
    id = id << 4 | static_cast<std::uint32_t>(digit(c));
  }
  std::string_view data = frame.substr(mark + 1);
  if ((id & kError) != 0 || (!data.empty() && data[0] == 'R')) return std::nullopt;
  const bool fd = !data.empty() && data[0] == '#';
  if (fd && (data.size() < 2 || digit(data[1]) < 0)) refuseLine(line, "flags expected after ##");
  out.message = canMessage(id & kExtended,
                           dataOf(line, data.substr(fd ? 2 : 0), fd ? kFdData : kClassicData));
  return out;
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
