#include "libperception/config/IniFile.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <system_error>

#include "libperception/core/system/PartialFile.h"

namespace perception {
namespace {

constexpr std::size_t kLargestFile = 4u << 20;  // [bytes]; a larger file is no INI

}  // namespace

std::string readWhole(const std::string& path, std::string& content) {
  if (const auto what = irregularity(path); !what.empty() && what != "a directory")
    return fmt::format("is {}, expected a configuration file", what);
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rbe"));
  if (!file) return fmt::format("cannot be read: {}", std::strerror(errno));
  char block[1 << 14];
  std::size_t count = 0;
  errno = 0;
  while ((count = std::fread(block, 1, sizeof block, file.get())) > 0) {
    content.append(block, count);
    if (content.size() > kLargestFile) {
      return fmt::format("has more than {} bytes, expected a configuration file", kLargestFile);
    }
  }
  if (std::ferror(file.get())) return fmt::format("cannot be read: {}", std::strerror(errno));
  return "";
}

std::string folderOf(const std::string& path) {
  return std::filesystem::path(path).parent_path().string();
}

std::string joined(const std::string& folder, const std::string& path) {
  return folder.empty() ? path : (std::filesystem::path(folder) / path).string();
}

std::string identityOf(const std::string& path) {
  std::error_code error;
  const auto canonical = std::filesystem::canonical(path, error);
  return error ? path : canonical.string();
}

}  // namespace perception
