#include "libperception/interop/bags/InflatedFile.h"

#include <fmt/format.h>
#include <unistd.h>
#include <zstd.h>

#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <utility>
#include <vector>

#include "libperception/core/Error.h"

namespace perception {
namespace {

void writeAll(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const auto done = ::write(file, bytes.data(), bytes.size());
    if (done < 0 && errno == EINTR) continue;
    if (done < 0)
      throw OutputError(
          fmt::format("a temporary file for an inflated recording: {}", std::strerror(errno)),
          ExitCode::kIoError);
    bytes.remove_prefix(static_cast<std::size_t>(done));
  }
}

class InsideBag final : public ReadingBag {
 public:
  InsideBag(const std::string& path, std::unique_ptr<ReadingBag> bag,
            std::unique_ptr<InflatedFile> file)
      : ReadingBag(path), file_(std::move(file)), bag_(std::move(bag)) {
    if (!file_->fault().empty()) faults_.push_back(fmt::format("{}: {}", path, file_->fault()));
  }
  std::uint64_t bytesRead() const override { return bag_->bytesRead(); }
  std::uint64_t fileBytes() const override { return bag_->fileBytes(); }

 private:
  bool nextStored(BagMessage& message) override {
    if (bag_->next(message)) return true;
    for (; told_ < bag_->faults().size(); ++told_) faults_.push_back(bag_->faults()[told_]);
    return false;
  }

  std::unique_ptr<InflatedFile> file_;  // closed after its reader
  std::unique_ptr<ReadingBag> bag_;
  std::size_t told_ = 0;
};

}  // namespace

InflatedFile::InflatedFile(const std::string& path)
    : path_((std::filesystem::temp_directory_path() / "perception_inflated_XXXXXX").string()) {
  const int file = ::mkstemp(path_.data());
  if (file < 0)
    throw OutputError(fmt::format("{}: {}", path_, std::strerror(errno)), ExitCode::kIoError);
  removed_if_killed_ = std::make_unique<TemporaryPath>(path_);
  try {
    fill(path, file);
  } catch (...) {
    ::close(file);
    ::unlink(path_.c_str());
    throw;
  }
  ::close(file);
}

InflatedFile::~InflatedFile() { ::unlink(path_.c_str()); }

void InflatedFile::fill(const std::string& from, int to) {
  std::ifstream in(from, std::ios::binary);
  if (!in) throw DataError(fmt::format("{}: {}", from, std::strerror(errno)), ExitCode::kNoInput);
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> stream(ZSTD_createDStream(),
                                                                             &ZSTD_freeDStream);
  std::vector<char> read(ZSTD_DStreamInSize()), got(ZSTD_DStreamOutSize());
  std::size_t hint = 1;
  std::uint64_t written = 0;
  while (fault_.empty() &&
         (in.read(read.data(), static_cast<std::streamsize>(read.size())) || in.gcount() > 0)) {
    ZSTD_inBuffer input{read.data(), static_cast<std::size_t>(in.gcount()), 0};
    for (bool more = true; more;) {
      ZSTD_outBuffer output{got.data(), got.size(), 0};
      hint = ZSTD_decompressStream(stream.get(), &output, &input);
      if (ZSTD_isError(hint) != 0)
        fault_ =
            fmt::format("bad zstd data ({}): all behind it is left out", ZSTD_getErrorName(hint));
      else
        writeAll(to, {got.data(), output.pos}), written += output.pos;
      more = fault_.empty() && (input.pos < input.size || output.pos == output.size);
    }
  }
  if (fault_.empty() && hint != 0) fault_ = "the zstd data end early: the file is cut";
  if (written == 0) throw DataError(fmt::format("{}: nothing in it: {}", from, fault_));
}

std::unique_ptr<ReadingBag> insideBag(const std::string& path, std::unique_ptr<ReadingBag> bag,
                                      std::unique_ptr<InflatedFile> file) {
  return std::make_unique<InsideBag>(path, std::move(bag), std::move(file));
}

}  // namespace perception
