#include "libperception/app/OutputFolder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "libperception/core/Error.h"

namespace perception {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLast = "done.json";

void createFolder(const fs::path& path) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error)) {
    throw OutputError(path.string() +
                      ": cannot be the output folder: a file of that name is there");
  }
  fs::create_directories(path, error);
  if (error)
    throw OutputError(fmt::format("{}: cannot be created: {}", path.string(), error.message()));
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path)
    : path_(path), temporary_(fmt::format("{}/.partial.{}", path, static_cast<long>(::getpid()))) {
  createFolder(path_);
  createFolder(temporary_);
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  fs::remove_all(temporary_, ignored);
}

void OutputFolder::commit() {
  std::error_code error;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(temporary_))
    files.push_back(entry.path().filename());
  std::sort(files.begin(), files.end(), [](const fs::path& a, const fs::path& b) {
    return std::pair(a == kLast, a) < std::pair(b == kLast, b);
  });
  fs::remove(fs::path(path_) / kLast, error);  // from here on the old result is not whole
  for (const auto& f : files) {
    fs::rename(fs::path(temporary_) / f, fs::path(path_) / f, error);
    if (error) {
      throw OutputError(
          fmt::format("{}/{}: cannot be put in place: {}", path_, f.string(), error.message()),
          ExitCode::kIoError);
    }
  }
}

}  // namespace perception
