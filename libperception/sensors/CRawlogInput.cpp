#include "libperception/sensors/CRawlogInput.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "libperception/core/Error.h"
#include "libperception/core/PartialFile.h"

namespace perception {

namespace {

constexpr std::size_t kRawBytes = 1U << 18;
constexpr std::size_t kReadyBytes = 1U << 20;
constexpr int kGzipWindow =
    15 + 16;  ///< zlib: largest window, gzip container with check of CRC and length

}  // namespace

struct CRawlogInput::Inflater {
  z_stream z{};
  bool in_member = true;  ///< between the header and the trailer of a member
  Inflater() { inflateInit2(&z, kGzipWindow); }
  ~Inflater() { inflateEnd(&z); }
};

CRawlogInput::CRawlogInput(const std::string& path) : path_(path) {
  struct stat info {};
  // stat() before open(): opening a pipe would wait for a writer.
  if (::stat(path.c_str(), &info) != 0) {
    throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
  }
  if (const auto what = irregularity(path); !what.empty())
    throw DataError(fmt::format("{}: not a rawlog but {}", path, what));
  if (info.st_size == 0) throw DataError(fmt::format("{}: not a rawlog but an empty file", path));
  file_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file_ < 0)
    throw DataError(fmt::format("{}: {}", path, std::strerror(errno)), ExitCode::kNoInput);
  file_bytes_ = static_cast<std::uint64_t>(info.st_size);
  raw_.reserve(kRawBytes);
  if (readFile() && raw_.size() >= 2 && raw_[0] == 0x1f && raw_[1] == 0x8b) {
    compressed_ = true;
    members_ = 1;
    inflater_ = std::make_unique<Inflater>();
    inflater_->z.next_in = raw_.data();
    inflater_->z.avail_in = static_cast<uInt>(raw_.size());
  }
}

CRawlogInput::~CRawlogInput() {
  if (file_ >= 0) ::close(file_);
}

void CRawlogInput::stop(State state, const std::string& reason) {
  if (state_ != State::kGood) return;
  state_ = state;
  reason_ = reason;
}

bool CRawlogInput::readFile() {
  raw_.resize(kRawBytes);
  ssize_t got = 0;
  do {
    got = ::read(file_, raw_.data(), raw_.size());
  } while (got < 0 && errno == EINTR);
  if (got < 0) stop(State::kFailed, fmt::format("reading failed: {}", std::strerror(errno)));
  raw_.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
  file_read_ += raw_.size();
  return !raw_.empty();
}

bool CRawlogInput::fillPlain() {
  if (raw_.empty() && !readFile()) {
    stop(State::kEnd, "");
    return false;
  }
  ready_.insert(ready_.end(), raw_.begin(), raw_.end());
  raw_.clear();
  return true;
}

bool CRawlogInput::fillInflated() {
  z_stream& z = inflater_->z;
  const std::size_t before = ready_.size();
  ready_.resize(before + kReadyBytes);
  z.next_out = ready_.data() + before;
  z.avail_out = kReadyBytes;
  // Loop: an input block may inflate to nothing (headers, trailers).
  while (z.avail_out == kReadyBytes && state_ == State::kGood) {
    if (z.avail_in == 0) {
      if (!readFile()) {
        stop(inflater_->in_member ? State::kTorn : State::kEnd,
             "the file ends inside its gzip container");
        break;
      }
      z.next_in = raw_.data();
      z.avail_in = static_cast<uInt>(raw_.size());
    }
    if (!inflater_->in_member) {  // only another member may follow
      if (z.next_in[0] != 0x1f) {
        stop(State::kDamaged, "other data follow the end of the gzip container");
        break;
      }
      inflateReset2(&z, kGzipWindow);
      inflater_->in_member = true;
      ++members_;
    }
    const int result = inflate(&z, Z_NO_FLUSH);
    if (result == Z_STREAM_END) {
      inflater_->in_member = false;
    } else if (result != Z_OK && result != Z_BUF_ERROR) {
      stop(State::kDamaged,
           fmt::format("bad gzip data near byte {} of the file ({})", file_read_ - z.avail_in,
                       z.msg != nullptr ? z.msg : "zlib error"));
    }
  }
  ready_.resize(before + kReadyBytes - z.avail_out);
  return ready_.size() > before;
}

bool CRawlogInput::fill() {
  if (state_ != State::kGood) return false;
  ready_.erase(ready_.begin(), ready_.begin() + static_cast<std::ptrdiff_t>(ready_begin_));
  ready_begin_ = 0;
  return compressed_ ? fillInflated() : fillPlain();
}

bool CRawlogInput::atEnd() { return ready_begin_ == ready_.size() && !fill(); }

std::string CRawlogInput::peek(std::size_t count) {
  while (ready_.size() - ready_begin_ < count && fill()) {
  }
  const auto begin = ready_.begin() + static_cast<std::ptrdiff_t>(ready_begin_);
  return std::string(
      begin, begin + static_cast<std::ptrdiff_t>(std::min(count, ready_.size() - ready_begin_)));
}

std::size_t CRawlogInput::read(void* to, std::size_t count) {
  auto* out = static_cast<unsigned char*>(to);
  for (std::size_t left = count; left > 0;) {
    if (atEnd()) {
      if (state_ == State::kEnd) {
        state_ = State::kTorn;
        reason_ = "the file ends inside an entry";
      }
      throw std::runtime_error(reason_);
    }
    const std::size_t part = std::min(left, ready_.size() - ready_begin_);
    std::memcpy(out, ready_.data() + ready_begin_, part);
    ready_begin_ += part;
    position_ += part;
    out += part;
    left -= part;
  }
  return count;
}

std::size_t CRawlogInput::write(const void*, std::size_t) {
  throw std::logic_error("CRawlogInput: read only");
}

}  // namespace perception
