#include "libperception/sensors/rawlog/CRawlogOutput.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/statvfs.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace perception {

namespace {

constexpr std::size_t kOutBytes = 1U << 18;
constexpr std::size_t kMostAtOnce = 1U << 30;  ///< zlib counts in 32 bits

/// MRPT writes many fields of a few bytes: they are buffered before compression.
constexpr std::size_t kGather = 1U << 16;

}  // namespace

struct CRawlogOutput::Deflater {
  z_stream z{};
  std::string gathered;
  std::array<unsigned char, kOutBytes> out{};
  explicit Deflater(int level) {
    deflateInit2(&z, level, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY);
  }
  ~Deflater() { deflateEnd(&z); }
};

CRawlogOutput::CRawlogOutput(const std::string& path, int gzip_level)
    : path_(path), deflater_(std::make_unique<Deflater>(std::clamp(gzip_level, 0, 9))) {
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (file_ < 0)
    throw OutputError(fmt::format("{}: cannot create: {}", path, std::strerror(errno)));
}

CRawlogOutput::~CRawlogOutput() {
  if (file_ >= 0) ::close(file_);
}

void CRawlogOutput::fail(const char* what) {
  const int error = errno;
  std::string room;
  struct statvfs disk {};
  if (error == ENOSPC && ::statvfs(path_.c_str(), &disk) == 0) {
    room =
        fmt::format(" ({} bytes free)", static_cast<std::uint64_t>(disk.f_bavail) * disk.f_frsize);
  }
  failure_.emplace(fmt::format("{}: {}: {}{}", path_, what, std::strerror(error), room),
                   ExitCode::kIoError);
  throw *failure_;
}

void CRawlogOutput::writeFile(const unsigned char* from, std::size_t count) {
  while (count > 0) {
    const ssize_t written = ::write(file_, from, count);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("writing failed");
    from += written;
    count -= static_cast<std::size_t>(written);
    bytes_out_ += static_cast<std::uint64_t>(written);
  }
}

void CRawlogOutput::deflateSome(const void* from, std::size_t count, int flush) {
  z_stream& z = deflater_->z;
  z.next_in = static_cast<Bytef*>(const_cast<void*>(from));  // zlib does not write to it
  z.avail_in = static_cast<uInt>(count);
  do {
    z.next_out = deflater_->out.data();
    z.avail_out = static_cast<uInt>(deflater_->out.size());
    deflate(&z, flush);
    writeFile(deflater_->out.data(), deflater_->out.size() - z.avail_out);
  } while (z.avail_out == 0);
}

std::size_t CRawlogOutput::write(const void* from, std::size_t count) {
  std::string& gathered = deflater_->gathered;
  bytes_in_ += count;
  if (gathered.size() + count <= kGather) {
    gathered.append(static_cast<const char*>(from), count);
    return count;
  }
  deflateSome(gathered.data(), gathered.size(), Z_NO_FLUSH);
  gathered.clear();
  const char* rest = static_cast<const char*>(from);
  for (std::size_t left = count; left > 0;) {
    const std::size_t part = std::min(left, kMostAtOnce);
    deflateSome(rest, part, Z_NO_FLUSH);
    rest += part;
    left -= part;
  }
  return count;
}

void CRawlogOutput::finish() {
  deflateSome(deflater_->gathered.data(), deflater_->gathered.size(), Z_FINISH);
  deflater_->gathered.clear();
  if (::fsync(file_) != 0 && errno != EINVAL && errno != ENOTSUP)
    fail("writing to the disk failed");
  const int file = file_;
  file_ = -1;
  if (::close(file) != 0) fail("closing failed");
}

std::size_t CRawlogOutput::read(void*, std::size_t) {
  throw std::logic_error("CRawlogOutput: write only");
}

}  // namespace perception
