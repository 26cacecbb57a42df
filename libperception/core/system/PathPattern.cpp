#include "libperception/core/system/PathPattern.h"

#include <glob.h>

namespace perception {

std::vector<std::string> pathsMatching(const std::string& pattern) {
  std::vector<std::string> paths;
  glob_t found{};
  if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
    paths.assign(found.gl_pathv, found.gl_pathv + found.gl_pathc);
  globfree(&found);
  return paths;
}

}  // namespace perception
