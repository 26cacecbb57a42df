#include "libperception/interop/bags/ByteSource.h"

#include <fmt/format.h>

#include <cerrno>
#include <filesystem>
#include <fstream>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {
namespace {

class FileSource final : public ByteSource {
 public:
  explicit FileSource(const std::string& path) : path_(path) {
    if (const auto what = irregularity(path); !what.empty())
      throw DataError(fmt::format("{}: not a recording but {}", path, what));
    file_.open(path, std::ios::binary);
    if (!file_)
      throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
    size_ = std::filesystem::file_size(path);
    if (size_ == 0) throw DataError(fmt::format("{}: an empty file", path));
  }

 private:
  std::string_view bytesAt(std::uint64_t, std::uint64_t size) override {
    buffer_.resize(size);
    if (!file_.read(buffer_.data(), static_cast<std::streamsize>(size)))
      throw DataError(fmt::format("{}: reading failed at byte {}", path_, position_),
                      ExitCode::kIoError);
    return buffer_;
  }

  std::string path_, buffer_;
  std::ifstream file_;
};

class MemorySource final : public ByteSource {
 public:
  explicit MemorySource(std::string bytes) : bytes_(std::move(bytes)) { size_ = bytes_.size(); }

 private:
  std::string_view bytesAt(std::uint64_t position, std::uint64_t size) override {
    return std::string_view(bytes_).substr(position, size);
  }
  std::string bytes_;
};

}  // namespace

void ByteSource::check(std::uint64_t size, const char* what) const {
  if (size > left()) {
    throw std::runtime_error(fmt::format("byte {}: expected {} of {} bytes, but {} are left",
                                         position_, what, size, left()));
  }
}

std::string_view ByteSource::take(std::uint64_t size, const char* what) {
  check(size, what);
  const std::string_view bytes = bytesAt(position_, size);
  position_ += size;
  return bytes;
}

void ByteSource::skip(std::uint64_t size, const char* what) {
  check(size, what);
  constexpr std::uint64_t kBlock = 1 << 20;
  for (; size > kBlock; size -= kBlock) take(kBlock, what);
  take(size, what);
}

std::unique_ptr<ByteSource> fileSource(const std::string& path) {
  return std::make_unique<FileSource>(path);
}

std::unique_ptr<ByteSource> memorySource(std::string bytes) {
  return std::make_unique<MemorySource>(std::move(bytes));
}

}  // namespace perception
