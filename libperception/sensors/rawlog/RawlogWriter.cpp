#include "libperception/sensors/rawlog/RawlogWriter.h"

#include <fmt/format.h>

#include <filesystem>
#include <vector>

#include "libperception/core/Error.h"
#include "libperception/sensors/observations/registerClasses.h"
#include "libperception/sensors/rawlog/CRawlogInput.h"
#include "libperception/sensors/rawlog/CRawlogOutput.h"

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

}  // namespace

RawlogWriter::RawlogWriter(const std::string& path, int gzip_level) : path_(path), file_(path) {
  registerPerceptionClasses();
  if (std::filesystem::is_directory(path))
    throw OutputError(fmt::format("{}: is a directory", path));
  output_ = std::make_unique<CRawlogOutput>(file_.path(), gzip_level);
}

RawlogWriter::~RawlogWriter() = default;

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

void RawlogWriter::finish() {
  if (finished_) return;
  output_->finish();
  if (!holds(file_.path(), output_->bytesIn())) {
    throw OutputError(fmt::format("{}: what was read back is not what was written", file_.path()),
                      ExitCode::kIoError);
  }
  finished_ = true;
  std::error_code error;
  std::filesystem::remove(path_, error);
  if (error) throw OutputError(fmt::format("{}: cannot be replaced: {}", path_, error.message()));
}

void RawlogWriter::close() {
  finish();
  file_.commit();
}

}  // namespace perception
