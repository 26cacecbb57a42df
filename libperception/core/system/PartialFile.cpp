#include "libperception/core/system/PartialFile.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "libperception/core/Error.h"

namespace perception {
namespace {

/// Folders are written as such, and whoever opens them fails with the reason.
std::string placeOf(const std::string& name) {
  return irregularity(name).empty() ? partialPath(name) : name;
}

/// So that the new name survives a power failure; errors are ignored.
void syncFolderOf(const std::string& path) {
  const auto parent = std::filesystem::path(path).parent_path();
  const int folder =
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  ::fsync(folder);
  ::close(folder);
}

}  // namespace

PartialFile::PartialFile(const std::string& name)
    : name_(name),
      path_(placeOf(name)),
      in_temporary_folder_(TemporaryPath::holds(name)),
      removed_if_killed_(path_ == name_ ? "" : path_),
      pending_(path_ != name_) {}

PartialFile::~PartialFile() {
  if (pending_) std::remove(path_.c_str());
}

void PartialFile::commit() {
  if (!pending_) return;
  if (std::rename(path_.c_str(), name_.c_str()) != 0) {
    throw OutputError(
        fmt::format("{}: cannot rename {} to it: {}", name_, path_, std::strerror(errno)),
        ExitCode::kIoError);
  }
  pending_ = false;
  if (!in_temporary_folder_) syncFolderOf(name_);
}

std::string irregularity(const std::string& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0 || S_ISREG(info.st_mode)) return "";
  if (S_ISDIR(info.st_mode)) return "a directory";
  if (S_ISFIFO(info.st_mode)) return "a pipe";
  if (S_ISSOCK(info.st_mode)) return "a socket";
  return "a device";
}

}  // namespace perception
