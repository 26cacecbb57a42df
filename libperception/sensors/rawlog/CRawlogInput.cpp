#include "libperception/sensors/rawlog/CRawlogInput.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"
#include "libperception/sensors/rawlog/Inflater.h"

namespace perception {

namespace {

constexpr std::size_t kRawBytes = 1U << 18;
constexpr std::size_t kReadyBytes = 1U << 20;

}  // namespace

CRawlogInput::CRawlogInput(const std::string& path, FileSink sink)
    : path_(path), sink_(std::move(sink)) {
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
  if (readFile()) inflater_ = inflaterFor(raw_.data(), raw_.size());
  if (inflater_) members_ = 1;
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
  if (sink_) sink_(raw_.data(), raw_.size());
  return !raw_.empty();
}

bool CRawlogInput::fillPlain() {
  if (raw_.empty() && !readFile()) {
    stop(State::kEnd, "");
    return false;
  }
  std::copy(raw_.begin(), raw_.end(), roomFor(raw_.size()));
  ready_end_ += raw_.size();
  raw_.clear();
  return true;
}

/// The next block of the file, where the one before is used up; false at the end.
bool CRawlogInput::haveRaw() {
  if (raw_begin_ < raw_.size()) return true;
  raw_begin_ = 0;
  if (readFile()) return true;
  stop(in_member_ ? State::kTorn : State::kEnd,
       fmt::format("the file ends inside its {} container", inflater_->name()));
  return false;
}

bool CRawlogInput::fillInflated() {
  Inflater::Out out{roomFor(kReadyBytes), kReadyBytes};
  // Loop: an input block may inflate to nothing (headers, trailers).
  while (out.size == kReadyBytes && state_ == State::kGood && haveRaw()) {
    Inflater::In in{raw_.data() + raw_begin_, raw_.size() - raw_begin_};
    if (!in_member_) {  // only another member may follow
      if (!inflater_->begins(in.data[0])) {
        stop(State::kDamaged,
             fmt::format("other data follow the end of the {} container", inflater_->name()));
        break;
      }
      inflater_->reset();
      in_member_ = true;
      ++members_;
    }
    const Inflater::Step step = inflater_->step(in, out);
    raw_begin_ = raw_.size() - in.size;
    if (step == Inflater::Step::kMemberEnd) in_member_ = false;
    if (step == Inflater::Step::kBad) {
      stop(State::kDamaged,
           fmt::format("bad {} data near byte {} of the file ({})", inflater_->name(),
                       file_read_ - in.size, inflater_->fault()));
    }
  }
  ready_end_ += kReadyBytes - out.size;
  return out.size < kReadyBytes;
}

/// For bytes behind ready_end_.
unsigned char* CRawlogInput::roomFor(std::size_t bytes) {
  if (ready_.size() < ready_end_ + bytes) ready_.resize(ready_end_ + bytes);
  return ready_.data() + ready_end_;
}

bool CRawlogInput::fill() {
  if (state_ != State::kGood) return false;
  std::copy(ready_.data() + ready_begin_, ready_.data() + ready_end_, ready_.data());
  ready_end_ -= ready_begin_;
  ready_begin_ = 0;
  return inflater_ ? fillInflated() : fillPlain();
}

std::string CRawlogInput::container() const { return inflater_ ? inflater_->name() : ""; }

bool CRawlogInput::atEnd() { return ready_begin_ == ready_end_ && !fill(); }

std::string CRawlogInput::peek(std::size_t count) {
  while (ready_end_ - ready_begin_ < count && fill()) {
  }
  const auto begin = ready_.begin() + static_cast<std::ptrdiff_t>(ready_begin_);
  return std::string(
      begin, begin + static_cast<std::ptrdiff_t>(std::min(count, ready_end_ - ready_begin_)));
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
    const std::size_t part = std::min(left, ready_end_ - ready_begin_);
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
