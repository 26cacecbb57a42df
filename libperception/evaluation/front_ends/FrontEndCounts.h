#pragma once
#include <cstddef>
#include <map>
#include <string>

namespace perception {

/// Counts of truth objects in a sensor's view, summed over scans.
struct RecallCounts {
  std::size_t in_view = 0;
  std::size_t found = 0;          ///< with any measurement on it
  std::size_t named = 0;          ///< with one whose label names its class
  std::size_t named_primary = 0;  ///< the same with primary labels only (LabelMeaning)
  std::size_t measurements =
      0;  ///< number of measurements on it; larger than `found` where an object gives several

  RecallCounts& operator+=(const RecallCounts& other);
};

/// Counts of measurements of one label, summed over scans.
struct PrecisionCounts {
  std::size_t measurements = 0;
  std::size_t right_class = 0;            ///< on an object of a class that the label names
  std::size_t right_size = 0;             ///< on any object of the size that the label states
  std::map<std::string, std::size_t> on;  ///< by truth type; kNothing: on no truth object

  PrecisionCounts& operator+=(const PrecisionCounts& other);
};
inline constexpr const char* kNothing = "nothing in the truth";

}  // namespace perception
