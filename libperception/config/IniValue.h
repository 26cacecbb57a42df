#pragma once
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libperception/config/ParamSet.h"

namespace perception {

// Conversion of INI values from and to text, independent of the locale. Parsers accept the whole
// text or return nothing.

std::optional<double> parseReal(std::string_view text);  ///< finite; decimal point, no hex
std::optional<long long> parseInteger(std::string_view text);
std::optional<unsigned long long> parseUnsigned(std::string_view text);
std::optional<bool> parseBoolean(std::string_view text);  ///< true false yes no on off 1 0
/// Splits at commas and trims each part; empty parts are kept.
std::vector<std::string_view> splitList(std::string_view text);
/// Removes white space at both ends.
std::string_view trimmed(std::string_view text);

/// The shortest text that parseReal converts back to the same bits.
std::string formatReal(double value);
/// The shortest text in degrees that is read back as the same angle [rad] to the bit; nothing when
/// there is none.
std::optional<std::string> formatDegrees(double angle_rad);
/// Whether the text is unchanged when written as `key = text` and read back: not empty, one line,
/// no comment in it.
bool survivesWriting(std::string_view text);
/// Where a comment begins (; or # at the start or after white space) or the text's size.
std::size_t commentStart(std::string_view text);

inline bool isWithin(Bounds allowed, double value) {
  return value >= allowed.low && value <= allowed.high;
}

/// "0.05 .. 5", ">= 0", "" without bounds.
std::string rangeText(Bounds allowed);
/// The text on one line: control characters as \x1b.
std::string escaped(std::string_view text);
/// The text in quotes for a message: control characters escaped, cut when long.
std::string inQuotes(std::string_view text);
/// The candidate with the smallest edit distance to `word`; "" when that exceeds a third of its
/// length.
std::string nearestWord(const std::string& word, const std::vector<std::string>& candidates);

}  // namespace perception
