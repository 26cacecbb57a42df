#pragma once
#include <cstddef>
#include <map>
#include <string>

namespace perception {

/// Truth objects in a sensor's view, over all scans.
struct RecallCounts {
  std::size_t in_view = 0;
  std::size_t found = 0;          ///< some measurement lies on it
  std::size_t named = 0;          ///< one whose label names its class
  std::size_t named_primary = 0;  ///< one with such a label that names its class
  std::size_t measurements = 0;   ///< that lie on it: more than found where objects fall apart

  RecallCounts& operator+=(const RecallCounts& other);
};

/// Measurements of one label, over all scans.
struct PrecisionCounts {
  std::size_t measurements = 0;
  std::size_t right_class = 0;            ///< on an object of a class that the label names
  std::size_t right_size = 0;             ///< on anything of the size that the label says
  std::map<std::string, std::size_t> on;  ///< by kind of thing; kNothing: nothing of the truth

  PrecisionCounts& operator+=(const PrecisionCounts& other);
};
inline constexpr const char* kNothing = "nothing in the truth";

}  // namespace perception
