#pragma once
#include <string>
#include <vector>

namespace perception {

/// Files and folders that match a shell pattern (* ? [...]), sorted by name; the path itself where
/// it is no pattern and exists.
std::vector<std::string> pathsMatching(const std::string& pattern);

/// Last folder of the path: name of a run in tables and titles.
std::string lastFolderOf(const std::string& path);

}  // namespace perception
