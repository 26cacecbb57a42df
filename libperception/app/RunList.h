#pragma once
#include <string>
#include <vector>

namespace perception {

/// One run to be evaluated; empty condition: not pooled.
struct RunEntry {
  std::string condition, dir, truth;
};

/// Expands -r, -t and --manifest, in that order. Throws Error (kUsage), DataError.
std::vector<RunEntry> runEntries(const std::vector<std::string>& runs,
                                 const std::string& truth_file, const std::string& manifest);

/// Last folders if they are unique, else the paths as given.
std::vector<std::string> namesOfRuns(const std::vector<std::string>& runs);

}  // namespace perception
