#pragma once
#include <string>

namespace perception {

/// Folder of the INIs, models and the demo log that were installed with this library: the
/// environment's PERCEPTION_DATA, else share/perception below a folder above the one that holds the
/// program or the library; "" where there is none (as in a build tree).
std::string installedFolder();

/// `path` where it exists; else the installed INI of that relative `name`, with or without its
/// leading ini/; else `path`.
std::string foundOrInstalled(const std::string& path, const std::string& name);

}  // namespace perception
