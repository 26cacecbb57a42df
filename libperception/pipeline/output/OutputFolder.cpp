#include "libperception/pipeline/output/OutputFolder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "libperception/core/Error.h"
#include "libperception/core/system/Supervision.h"

namespace perception {
namespace {

namespace fs = std::filesystem;

constexpr const char* kTemporaryPrefix = ".unfinished.";

[[noreturn]] void failCreating(const std::string& path, const std::string& reason) {
  throw OutputError(fmt::format("{}: cannot be created: {}", path, reason));
}

// False for names that would leave the folder.
bool staysInside(const fs::path& name) {
  return !name.empty() && name.is_relative() &&
         std::none_of(name.begin(), name.end(), [](const fs::path& part) { return part == ".."; });
}

}  // namespace

OutputFolder::OutputFolder(const std::string& path) : path_(path) {
  try {
    create();
    lock();
    removeLeftovers();
    temporary_ = fmt::format("{}/{}{}.{}", path_, kTemporaryPrefix, hostName(), ::getpid());
    removed_if_killed_.emplace(temporary_);
    std::error_code error;
    fs::create_directory(temporary_, error);
    if (error) failCreating(temporary_, error.message());
  } catch (...) {
    removeTemporaries();  // no destructor runs for a constructor that throws
    throw;
  }
}

OutputFolder::~OutputFolder() { removeTemporaries(); }

void OutputFolder::create() {
  if (path_.empty()) failCreating("''", "an output folder needs a name");
  while (path_.size() > 1 && path_.back() == '/') path_.pop_back();
  std::error_code error;
  const fs::file_status status = fs::status(path_, error);
  if (fs::is_directory(status)) return;
  if (fs::exists(status)) failCreating(path_, "a file of that name is there, expected a folder");
  // Parent by parent, so that an unfinished run removes exactly the folders that it created.
  fs::path folder;
  for (const auto& part : fs::path(path_)) {
    folder /= part;
    if (::mkdir(folder.c_str(), 0777) == 0) {
      made_.push_back(folder.string());
    } else if (const int reason = errno; !fs::is_directory(folder, error)) {
      failCreating(path_, reason == EEXIST ? folder.string() + " is not a folder"
                                           : std::string(std::strerror(reason)));
    }
  }
}

void OutputFolder::lock() {
  lock_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock_ < 0) failCreating(path_, std::strerror(errno));
  // Some network disks cannot lock a folder; two runs are safe there too, since each renames
  // complete files.
  if (::flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    throw Error(ExitCode::kTryAgain, fmt::format("{}: busy: another run writes into it", path_));
  }
}

// Removes files of killed runs on this host only: on a shared disk other hosts may be writing.
void OutputFolder::removeLeftovers() const {
  const std::string prefix = fmt::format("{}{}.", kTemporaryPrefix, hostName());
  std::error_code error;
  for (fs::directory_iterator i(path_, error), end; !error && i != end; i.increment(error)) {
    const std::string name = i->path().filename().string();
    if (name.compare(0, prefix.size(), prefix) != 0) continue;
    const auto process = static_cast<pid_t>(std::strtol(name.c_str() + prefix.size(), nullptr, 10));
    const bool ours = process == ::getpid();
    const bool gone = process > 0 && !isAlive(process);
    std::error_code ignored;
    if (ours || gone) fs::remove_all(i->path(), ignored);
  }
}

void OutputFolder::removeTemporaries() noexcept {
  std::error_code ignored;
  if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
  if (!committed_) {  // rmdir does not remove folders that are not empty
    for (auto i = made_.rbegin(); i != made_.rend(); ++i) ::rmdir(i->c_str());
  }
  made_.clear();
  if (lock_ >= 0) ::close(lock_);
  lock_ = -1;
}

std::string OutputFolder::pathFor(const std::string& name) {
  if (!staysInside(name)) failCreating(name, "expected a name inside the output folder");
  const std::string path = temporary_ + "/" + name;
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  if (error) failCreating(path, error.message());
  if (std::find(names_.begin(), names_.end(), name) == names_.end()) names_.push_back(name);
  return path;
}

void OutputFolder::adoptAll() {
  for (const auto& entry : fs::recursive_directory_iterator(temporary_)) {
    if (!entry.is_directory()) pathFor(entry.path().lexically_relative(temporary_).string());
  }
}

void OutputFolder::failWriting(const std::string& path, int reason) const {
  std::error_code error;
  const auto space = fs::space(path_, error);
  throw OutputError(fmt::format("{}: cannot be written: {}{}", path, std::strerror(reason),
                                error ? "" : fmt::format(" ({} bytes free)", space.available)),
                    ExitCode::kIoError);
}

/// All begin at once what handToDisk() waits for, one file after the other.
void OutputFolder::beginWriting() const {
  for (const auto& name : names_) {
    const int file = ::open((temporary_ + "/" + name).c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) continue;
    ::sync_file_range(file, 0, 0, SYNC_FILE_RANGE_WRITE);
    ::close(file);
  }
}

void OutputFolder::handToDisk(const std::string& path) const {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) failWriting(path, errno);
  const int reason = ::fsync(file) == 0 ? 0 : errno;
  ::close(file);
  // Some file systems cannot sync a folder.
  if (reason != 0 && reason != EINVAL) failWriting(path, reason);
}

void OutputFolder::moveIntoPlace(const std::string& name) const {
  const std::string from = temporary_ + "/" + name, to = path_ + "/" + name;
  const std::string folder = fs::path(to).parent_path().string();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || ::rename(from.c_str(), to.c_str()) != 0) {
    failWriting(to, error ? error.value() : errno);
  }
  if (folder != path_) handToDisk(folder);
}

void OutputFolder::commit(const std::string& last) {
  assert(!committed_);
  beginWriting();
  for (const auto& name : names_) handToDisk(temporary_ + "/" + name);
  const std::string marker = path_ + "/" + last;
  bool changed = ::unlink(marker.c_str()) == 0;
  if (!changed && errno != ENOENT) failWriting(marker, errno);
  for (const auto& name : replaced_) {
    std::error_code error;
    if (staysInside(name)) fs::remove_all(path_ + "/" + name, error);
    if (error) failWriting(path_ + "/" + name, error.value());
    changed = true;
  }
  if (changed) handToDisk(path_);
  bool has_last = false;
  for (const auto& name : names_) {
    if (name == last) {
      has_last = true;
    } else {
      moveIntoPlace(name);
    }
  }
  handToDisk(path_);
  if (has_last) moveIntoPlace(last);
  handToDisk(path_);
  committed_ = true;
  removeTemporaries();
}

}  // namespace perception
