#include "libperception/core/system/PathPattern.h"

#include <glob.h>

#include <filesystem>

namespace perception {

std::vector<std::string> pathsMatching(const std::string& pattern) {
  std::vector<std::string> paths;
  glob_t found{};
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
    paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  globfree(&found);
  return paths;
}

std::string lastFolderOf(const std::string& path) {
  namespace fs = std::filesystem;
  const fs::path normal = fs::absolute(path).lexically_normal();
  return (normal.has_filename() ? normal.filename() : normal.parent_path().filename()).string();
}

}  // namespace perception
