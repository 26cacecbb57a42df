#include "libperception/interop/ros/PoseSeries.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <utility>

#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::size_t kRowsInBlock = 1024;

[[noreturn]] void failPoseFile(const std::string& path) {
  throw OutputError(fmt::format("{}: a temporary file for poses: {}", path, std::strerror(errno)),
                    ExitCode::kIoError);
}

}  // namespace

/// Bytes behind each other, without a name.
class PoseFile {
 public:
  PoseFile()
      : path_((std::filesystem::temp_directory_path() / "perception_poses_XXXXXX").string()),
        file_(::mkstemp(path_.data())) {
    if (file_ < 0) failPoseFile(path_);
    ::unlink(path_.c_str());
  }
  ~PoseFile() { ::close(file_); }
  PoseFile(const PoseFile&) = delete;
  PoseFile& operator=(const PoseFile&) = delete;

  void append(const void* bytes, std::size_t size) {
    for (std::size_t done = 0; done < size;) {
      const auto n = ::pwrite(file_, static_cast<const char*>(bytes) + done, size - done,
                              static_cast<::off_t>(end_ + done));
      if (n < 0 && errno != EINTR) failPoseFile(path_);
      if (n > 0) done += static_cast<std::size_t>(n);
    }
    end_ += size;
  }
  void read(std::size_t at, void* bytes, std::size_t size) const {
    for (std::size_t done = 0; done < size;) {
      const auto n = ::pread(file_, static_cast<char*>(bytes) + done, size - done,
                             static_cast<::off_t>(at + done));
      if (n == 0 || (n < 0 && errno != EINTR)) failPoseFile(path_);
      if (n > 0) done += static_cast<std::size_t>(n);
    }
  }

 private:
  std::string path_;
  int file_;
  std::size_t end_ = 0;
};

PoseSeries::PoseSeries() = default;
PoseSeries::PoseSeries(PoseSeries&&) noexcept = default;
PoseSeries& PoseSeries::operator=(PoseSeries&&) noexcept = default;
PoseSeries::~PoseSeries() = default;

void PoseSeries::add(Stamp stamp, const Pose3& pose) {
  if (size_ > 0) {
    const std::int64_t last = stored(size_ - 1).ns;
    in_order_ = in_order_ && stamp.ns >= last;
    once_ = once_ && stamp.ns != last;
  }
  if (newest_.size() == kRowsInBlock) {
    if (!file_) file_ = std::make_unique<PoseFile>();
    file_->append(newest_.data(), newest_.size() * sizeof(Stored));
    newest_.clear();
  }
  if (newest_.empty()) begins_.push_back(stamp.ns);
  Stored& row = newest_.emplace_back();
  row.ns = stamp.ns;
  Eigen::Map<Eigen::Matrix<double, 3, 4>>(row.matrix.data()) = pose.matrix().topRows<3>();
  ++size_;
}

const PoseSeries::Stored& PoseSeries::stored(std::size_t i) const {
  const std::size_t block = i / kRowsInBlock, at = i % kRowsInBlock;
  if (block == (size_ - 1) / kRowsInBlock) return newest_[at];
  Cached& cached = cached_[block % cached_.size()];
  if (cached.rows.empty() || cached.block != block) {
    cached.rows.resize(kRowsInBlock);
    file_->read(block * kRowsInBlock * sizeof(Stored), cached.rows.data(),
                kRowsInBlock * sizeof(Stored));
    cached.block = block;
  }
  return cached.rows[at];
}

PoseSeries::Row PoseSeries::row(std::size_t i) const {
  const Stored& from = stored(i);
  Row row{Stamp{from.ns}};
  row.pose.matrix().topRows<3>() =
      Eigen::Map<const Eigen::Matrix<double, 3, 4>>(from.matrix.data());
  return row;
}

void PoseSeries::sort(bool last_only) {
  if (in_order_ && (once_ || !last_only)) return;
  std::vector<std::pair<std::int64_t, std::size_t>> order;
  order.reserve(size_);
  for (std::size_t i = 0; i < size_; ++i) order.emplace_back(stored(i).ns, i);
  std::sort(order.begin(), order.end());
  PoseSeries sorted;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (last_only && k + 1 < order.size() && order[k + 1].first == order[k].first) continue;
    const Row next = row(order[k].second);
    sorted.add(next.stamp, next.pose);
  }
  *this = std::move(sorted);
}

void PoseSeries::keep(std::size_t first, std::size_t last) {
  if (first == 0 && last >= size_) return;
  PoseSeries kept;
  for (std::size_t i = first; i < std::min(last, size_); ++i) {
    const Row next = row(i);
    kept.add(next.stamp, next.pose);
  }
  *this = std::move(kept);
}

std::size_t PoseSeries::firstFrom(Stamp stamp) const {
  // The block before the first one that begins at the stamp or behind it.
  const auto behind = std::lower_bound(begins_.begin(), begins_.end(), stamp.ns);
  const auto block = static_cast<std::size_t>(behind - begins_.begin());
  std::size_t first = block == 0 ? 0 : (block - 1) * kRowsInBlock;
  std::size_t count = std::min(block * kRowsInBlock, size_) - first;
  while (count > 0) {
    const std::size_t half = count / 2;
    if (stored(first + half).ns < stamp.ns) {
      first += half + 1, count -= half + 1;
    } else {
      count = half;
    }
  }
  return first;
}

}  // namespace perception
