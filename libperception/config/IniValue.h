#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/config/ParamSet.h"

namespace perception {

// Text of an INI file to values and back, the same in every locale. A value is the whole text or
// nothing.

std::optional<double> parseReal(std::string_view text);  ///< finite; decimal point, no hex
std::optional<long long> parseInteger(std::string_view text);
std::optional<unsigned long long> parseUnsigned(std::string_view text);
std::optional<bool> parseBoolean(std::string_view text);  ///< true false yes no on off 1 0
/// The parts between commas without the white space around them; empty parts stay.
std::vector<std::string_view> splitList(std::string_view text);
/// Without white space at both ends.
std::string_view trimmed(std::string_view text);

/// The shortest text that parseReal turns into the same bits.
std::string formatReal(double value);
/// The shortest text in degrees that is the same angle [rad] to the bit when read; nothing when
/// there is none.
std::optional<std::string> formatDegrees(double angle_rad);
/// Whether the text survives being written behind `key = ` and read again: not empty, one line, no
/// comment in it.
bool survivesWriting(std::string_view text);
/// Where a comment begins (; or # at the start or after white space) or the text's size.
std::size_t commentStart(std::string_view text);

inline bool isWithin(Bounds allowed, double value) {
  return value >= allowed.low && value <= allowed.high;
}

/// "0.05 .. 5", ">= 0", "" when everything is allowed.
std::string rangeText(Bounds allowed);
/// The text on one line: control characters as \x1b.
std::string escaped(std::string_view text);
/// The text in quotes for a message: control characters escaped, cut when long.
std::string inQuotes(std::string_view text);
/// The candidate most like `word`, "" when none is near (edit distance up to a third of its
/// length).
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace perception
