#include "libperception/sensors/rawlog/ObservationStream.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <mrpt/serialization/CSerializable.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

#include "libperception/core/Error.h"
#include "libperception/sensors/observations/registerClasses.h"

namespace perception {
namespace {

constexpr char kMagic[] = {'P', 'O', 'b', 's'};
constexpr std::uint64_t kLargest = 1ULL << 30;  ///< [bytes] of one observation
constexpr int kPipeBytes = 1 << 20;             ///< asked of the kernel

struct Head {
  char magic[4];
  std::uint32_t dropped;
  std::uint64_t bytes;
  std::int64_t arrival_ns;
};
static_assert(sizeof(Head) == 24);

bool writeAll(int file, const void* from, std::size_t bytes) {
  const auto* at = static_cast<const char*>(from);
  while (bytes > 0) {
    const auto count = ::write(file, at, bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += count;
    bytes -= static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

StreamWriter::StreamWriter(const std::string& path) {
  registerPerceptionClasses();
  file_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (file_ < 0)
    throw OutputError(fmt::format("{}: cannot be created: {}", path, std::strerror(errno)));
  ::fcntl(file_, F_SETPIPE_SZ, kPipeBytes);  // no matter for files
}

StreamWriter::~StreamWriter() { ::close(file_); }

bool StreamWriter::write(const StreamEntry& entry) {
  mrpt::serialization::ObjectToOctetVector(entry.observation.get(), bytes_);
  Head head{};
  std::memcpy(head.magic, kMagic, sizeof kMagic);
  head.dropped = entry.dropped;
  head.bytes = bytes_.size();
  head.arrival_ns =
      std::chrono::duration_cast<std::chrono::nanoseconds>(entry.arrival.time_since_epoch())
          .count();
  return writeAll(file_, &head, sizeof head) && writeAll(file_, bytes_.data(), bytes_.size());
}

StreamReader::~StreamReader() { ::close(file_); }

/// False where the stream has ended before the first byte.
bool StreamReader::fill(void* to, std::size_t bytes) {
  auto* at = static_cast<char*>(to);
  for (std::size_t done = 0; done < bytes;) {
    const auto count = ::read(file_, at + done, bytes - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      if (done == 0) return false;
      throw std::runtime_error("the stream of observations ends within one");
    }
    done += static_cast<std::size_t>(count);
  }
  bytes_read_ += bytes;
  return true;
}

StreamReader::Result StreamReader::read(StreamEntry& entry, int milliseconds) {
  pollfd wait{file_, POLLIN, 0};
  if (::poll(&wait, 1, milliseconds) <= 0) return Result::kNothing;
  Head head{};
  if (!fill(&head, sizeof head)) return Result::kEnd;
  if (std::memcmp(head.magic, kMagic, sizeof kMagic) != 0 || head.bytes == 0 ||
      head.bytes > kLargest)
    throw std::runtime_error("not a stream of observations");
  bytes_.resize(head.bytes);
  if (!fill(bytes_.data(), bytes_.size()))
    throw std::runtime_error("the stream of observations ends within one");
  mrpt::serialization::CSerializable::Ptr object;
  mrpt::serialization::OctetVectorToObject(bytes_, object);
  entry.observation = std::dynamic_pointer_cast<mrpt::obs::CObservation>(object);
  if (!entry.observation) throw std::runtime_error("not a stream of observations");
  entry.arrival = std::chrono::steady_clock::time_point(std::chrono::nanoseconds(head.arrival_ns));
  entry.dropped = head.dropped;
  return Result::kEntry;
}

}  // namespace perception
