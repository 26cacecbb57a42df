#include "libperception/importers/truth/TruthTypes.h"

#include <array>
#include <utility>

namespace perception {
namespace {

/// Categories of Argoverse 2 (its annotation guide; a large vehicle is a fire truck, a recreational
/// vehicle) and aiMotive under other names than KITTI's.
constexpr std::array<std::pair<const char*, const char*>, 7> kTypes = {{
    {"REGULAR_VEHICLE", "Car"},
    {"LARGE_VEHICLE", "Truck"},
    {"BOX_TRUCK", "Truck"},
    {"TRUCK_CAB", "Truck"},
    {"SCHOOL_BUS", "Bus"},
    {"ARTICULATED_BUS", "Bus"},
    {"BICYCLIST", "Cyclist"},
}};

}  // namespace

std::string truthTypeOf(const std::string& category) {
  for (const auto& [from, to] : kTypes) {
    if (category == from) return to;
  }
  std::string type;
  bool begins = true;  // a word
  for (const char c : category) {
    const bool lower = c >= 'a' && c <= 'z', upper = c >= 'A' && c <= 'Z';  // ASCII, no locale
    if (c == '_') {
      begins = true;
      continue;
    }
    if (begins && lower) {
      type += static_cast<char>(c - 'a' + 'A');
    } else if (!begins && upper) {
      type += static_cast<char>(c - 'A' + 'a');
    } else {
      type += c;
    }
    begins = false;
  }
  return type;
}

}  // namespace perception
