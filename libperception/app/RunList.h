#pragma once
#include <string>
#include <vector>

namespace perception {

/// One run to be evaluated; of no condition: on its own.
struct RunEntry {
  std::string condition, dir, truth;
};

/// What -r, -t and --manifest ask for, in that order. Throws Error (kUsage), DataError.
std::vector<RunEntry> runEntries(const std::vector<std::string>& runs,
                                 const std::string& truth_file, const std::string& manifest);

/// Short names where they tell the runs apart, else the paths as given.
std::vector<std::string> namesOfRuns(const std::vector<std::string>& runs);

}  // namespace perception
