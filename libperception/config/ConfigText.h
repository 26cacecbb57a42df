#pragma once
#include <string>
#include <string_view>

#include "libperception/config/ParamSet.h"

namespace perception {

/// "a number in 0 .. 5 [m]", as the second half of "found X, expected Y".
std::string expectedNumber(const char* kind, Bounds allowed, const std::string& unit);

/// A hint on a common mistake in the text (decimal comma, `//` comment), " (...)"; "": none.
std::string hint(std::string_view text);

/// "[m] 0.05 .. 5: what it is": unit, what is allowed, purpose.
std::string comment(const std::string& unit, const std::string& allowed, const char* doc);

/// Values separated by commas, each written by `format`.
template <class Values, class Format>
std::string listText(const Values& values, Format format) {
  std::string text;
  for (const auto& value : values) text += (text.empty() ? "" : ", ") + format(value);
  return text;
}

inline std::string sameWord(const std::string& word) { return word; }

}  // namespace perception
