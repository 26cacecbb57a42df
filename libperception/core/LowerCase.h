#pragma once
#include <string>

namespace perception {

/// The letters A to Z become a to z, whatever the locale; all other bytes stay, those of UTF-8,
/// too.
inline std::string lowerCase(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

}  // namespace perception
