#include "libperception/config/ShippedFiles.h"

#include <dlfcn.h>

#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace perception {
namespace fs = std::filesystem;
namespace {

/// The file that holds this code: a program or a shared library; "": unknown.
fs::path ownFile() {
  Dl_info info{};
  if (::dladdr(reinterpret_cast<const void*>(&shippedFolder), &info) == 0 ||
      info.dli_fname == nullptr)
    return {};
  std::error_code ignored;
  const fs::path loaded = fs::canonical(info.dli_fname, ignored);
  // Of a program the loader knows only the name that it was called by.
  return loaded.empty() ? fs::read_symlink("/proc/self/exe", ignored) : loaded;
}

bool isThere(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

}  // namespace

std::string shippedFolder() {
  if (const char* given = std::getenv("PERCEPTION_DATA"); given != nullptr && *given != '\0')
    return given;
  constexpr int kLevels = 5;  // PREFIX/lib/python3/dist-packages/perception/X.so
  fs::path folder = ownFile();
  for (int level = 0; level < kLevels && folder.has_relative_path(); ++level) {
    folder = folder.parent_path();
    if (isThere(folder / "share/perception/ini")) return (folder / "share/perception").string();
    if (isThere(folder / "ini/classes.ini")) return folder.string();
  }
  return {};
}

std::string foundOrShipped(const std::string& path, const std::string& name) {
  if (isThere(path) || name.empty() || name.front() == '/') return path;
  const fs::path shipped = shippedFolder();
  if (shipped.empty()) return path;
  for (const fs::path& candidate : {shipped / name, shipped / "ini" / name})
    if (isThere(candidate)) return candidate.string();
  return path;
}

std::string shippedName(const std::string& path) {
  const std::string shipped = shippedFolder();
  if (path.empty() || shipped.empty() || !isThere(path)) return path;
  std::error_code ignored;
  const fs::path name = fs::relative(path, shipped, ignored);
  return name.empty() || *name.begin() == ".." || name == "." ? path : name.string();
}

}  // namespace perception
