#pragma once
#include <string>
#include <string_view>

#include "libperception/config/ParamSet.h"

namespace perception {

/// "a number in 0 .. 5 [m]", as the second half of "found X, expected Y".
std::string expectedNumber(const char* kind, Bounds allowed, const std::string& unit);

/// What people are used to write elsewhere.
std::string hint(std::string_view text);

/// "[m] 0.05 .. 5: what it is": unit, what is allowed, purpose.
std::string comment(const std::string& unit, const std::string& allowed, const char* doc);

/// Values parted by commas, each as `format` writes it.
template <class Values, class Format>
std::string listText(const Values& values, Format format) {
  std::string text;
  for (const auto& value : values) text += (text.empty() ? "" : ", ") + format(value);
  return text;
}

inline std::string sameWord(const std::string& word) { return word; }

}  // namespace perception
