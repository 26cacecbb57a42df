#include "libperception/sensors/RawlogWriter.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/sensors/CRawlogInput.h"
#include "libperception/sensors/CRawlogOutput.h"
#include "libperception/sensors/registerClasses.h"

namespace perception {

namespace {

/// Inflates the whole file; true when its checksums match and it holds `bytes` bytes.
bool holds(const std::string& path, std::uint64_t bytes) {
  CRawlogInput input(path);
  std::vector<char> part(1U << 20);
  std::uint64_t left = bytes;
  for (; left > 0 && !input.atEnd(); left -= std::min<std::uint64_t>(left, part.size())) {
    const std::size_t count = std::min<std::uint64_t>(left, part.size());
    try {
      input.ReadBuffer(part.data(), count);
    } catch (const std::exception&) {
      return false;
    }
  }
  return left == 0 && input.atEnd() && input.state() == CRawlogInput::State::kEnd;
}

/// Syncs the folder, so that the new name survives a power failure; errors are ignored.
void syncFolderOf(const std::string& path) {
  const auto parent = std::filesystem::path(path).parent_path();
  const int folder =
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return;
  ::fsync(folder);
  ::close(folder);
}

}  // namespace

RawlogWriter::RawlogWriter(const std::string& path, int gzip_level)
    : path_(path), temporary_(partialPath(path)), removed_if_killed_(temporary_) {
  registerPerceptionClasses();
  if (std::filesystem::is_directory(path))
    throw OutputError(fmt::format("{}: is a directory", path));
  output_ = std::make_unique<CRawlogOutput>(temporary_, gzip_level);
}

RawlogWriter::~RawlogWriter() {
  if (closed_) return;
  output_.reset();
  std::remove(temporary_.c_str());
}

std::uint64_t RawlogWriter::bytes() const { return output_->bytesOut(); }
std::uint64_t RawlogWriter::bytesInflated() const { return output_->bytesIn(); }

void RawlogWriter::write(const mrpt::serialization::CSerializable& entry) {
  try {
    output_->WriteObject(entry);
  } catch (const std::exception&) {
    if (output_->failure()) throw *output_->failure();
    throw;
  }
  ++entries_;
}

void RawlogWriter::close() {
  if (closed_) return;
  output_->finish();
  if (!holds(temporary_, output_->bytesIn())) {
    throw OutputError(fmt::format("{}: what was read back is not what was written", temporary_),
                      ExitCode::kIoError);
  }
  if (std::rename(temporary_.c_str(), path_.c_str()) != 0) {
    throw OutputError(
        fmt::format("{}: cannot rename {} to it: {}", path_, temporary_, std::strerror(errno)),
        ExitCode::kIoError);
  }
  closed_ = true;
  syncFolderOf(path_);
}

}  // namespace perception
