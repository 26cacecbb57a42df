#include "libperception/config/ConfigText.h"

#include <fmt/format.h>

#include <algorithm>

#include "libperception/config/IniValue.h"

namespace perception {

std::string expectedNumber(const char* kind, Bounds allowed, const std::string& unit) {
  const std::string range = rangeText(allowed);
  const bool one_sided = !range.empty() && (range[0] == '>' || range[0] == '<');
  return fmt::format("{}{}{}{}", kind,
                     range.empty() ? ""
                     : one_sided   ? " "
                                   : " in ",
                     range, unit.empty() ? "" : " [" + unit + "]");
}

std::string hint(std::string_view text) {
  std::string with_point(text);
  const auto comma = with_point.find(',');
  if (comma != std::string::npos) {
    with_point[comma] = '.';
    if (parseReal(with_point)) return " (the decimal mark is a point)";
  }
  return text.find("//") != std::string_view::npos ? " (comments start with ; or #)" : "";
}

std::string comment(const std::string& unit, const std::string& allowed, const char* doc) {
  std::string text = unit.empty() ? "" : "[" + unit + "]";
  if (!allowed.empty()) text += (text.empty() ? "" : " ") + allowed + ":";
  text += (text.empty() ? "" : " ") + std::string(doc);
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

}  // namespace perception
