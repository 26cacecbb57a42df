#include "libperception/scene/files/OutputFile.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "libperception/core/Error.h"

namespace perception {

OutputFile::OutputFile(const std::string& path)
    : path_(path), partial_(path), file_(std::fopen(partial_.path().c_str(), "wbe")) {
  if (!file_)
    throw OutputError(fmt::format("{}: cannot be created: {}", path, std::strerror(errno)));
}

void OutputFile::write(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size()) fail(errno);
}

void OutputFile::close() {
  if (!file_) return;
  errno = 0;
  if (std::fflush(file_.get()) != 0) fail(errno);
  // Some file systems report a full disk only on sync; pipes and devices cannot be synced.
  if (!partial_.inTemporaryFolder() && ::fsync(::fileno(file_.get())) != 0 && errno != EINVAL &&
      errno != EROFS)
    fail(errno);
  if (std::fclose(file_.release()) != 0) fail(errno);
  partial_.commit();
}

void OutputFile::fail(int reason) const {
  std::error_code ignored;
  const auto parent = std::filesystem::absolute(path_, ignored).parent_path();
  const auto space = std::filesystem::space(parent, ignored);
  const std::string free =
      ignored ? "" : fmt::format(" ({} bytes free in its folder)", space.available);
  throw OutputError(
      fmt::format("{}: cannot be written: {}{}", path_, std::strerror(reason ? reason : EIO), free),
      ExitCode::kIoError);
}

void createFolder(const std::string& path) {
  std::error_code failed;
  if (!path.empty()) std::filesystem::create_directories(path, failed);
  if (failed) throw OutputError(fmt::format("{}: cannot be created: {}", path, failed.message()));
}

void writeFile(const std::string& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.close();
}

}  // namespace perception
