#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/packets/radars/CanBundle.h"

namespace perception::test::candump {

inline constexpr std::size_t kClassicData = 8, kFdData = 64;
inline constexpr std::uint32_t kError = 0x20000000, kExtended = 0x1FFFFFFF;

/// A line of `candump -l`: "(1436509052.249713) can0 123#1122AABB", of CAN FD "123##1AABB".
struct CandumpLine {
  std::int64_t stamp_ns = 0;
  std::string interface;
  std::string message;  ///< canMessage()
};
[[noreturn]] inline void refuseLine(std::string_view line, const std::string& what) {
  throw DataError("candump: '" + std::string(line.substr(0, 100)) + "': " + what);
}

inline int digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

/// Up to nine digits behind the point.
inline std::int64_t stampOf(std::string_view line, std::string_view text) {
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

inline std::string dataOf(std::string_view line, std::string_view hex, std::size_t most) {
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
inline std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t at = 0; at < line.size() && words.size() < 3;) {
    const std::size_t from = line.find_first_not_of(" \t\r\n", at);
    if (from == std::string_view::npos) break;
    at = std::min(line.find_first_of(" \t\r\n", from), line.size());
    words.push_back(line.substr(from, at - from));
  }
  return words;
}

/// Empty for an empty line, a comment, a remote or an error frame: they have no data. Throws
/// DataError for what is none of these.
inline std::optional<CandumpLine> parseCandump(std::string_view line) {
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

}  // namespace perception::test::candump
