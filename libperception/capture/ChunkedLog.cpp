#include "libperception/capture/ChunkedLog.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "libperception/core/Error.h"
#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace fs = std::filesystem;

namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

ChunkedLog::ChunkedLog(const std::string& folder, const ChunkLimits& limits)
    : folder_(folder), limits_(limits) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw OutputError(folder + ": " + error.message());
  if (fs::exists(folder + "/capture.jsonl"))
    throw OutputError(folder + ": holds a capture already; choose another folder");
}

void ChunkedLog::write(const mrpt::obs::CObservation& observation) {
  if (!chunk_) {
    name_ = fmt::format("capture_{:04}.rawlog", chunks_ + 1);
    chunk_ = std::make_unique<RawlogWriter>(folder_ + "/" + name_, limits_.gzip_level);
    opened_ = now();
    first_.reset();
    last_.reset();
  }
  chunk_->write(observation);
  const auto stamp = toStamp(observation.timestamp);
  if (!stamp) return;
  if (!first_ || *stamp < *first_) first_ = stamp;
  if (!last_ || *last_ < *stamp) last_ = stamp;
}

void ChunkedLog::tend() {
  if (chunk_ && (now() - opened_ >= limits_.seconds || chunk_->bytes() >= limits_.bytes)) close();
  std::error_code error;
  const auto space = fs::space(folder_, error);
  if (error || space.available >= limits_.free_bytes) return;
  close();
  throw OutputError(
      fmt::format("{}: {:.1f} MB are free, less than {:.1f} MB: the capture ends here", folder_,
                  static_cast<double>(space.available) * 1e-6,
                  static_cast<double>(limits_.free_bytes) * 1e-6),
      ExitCode::kIoError);
}

void ChunkedLog::close() {
  if (!chunk_) return;
  const std::unique_ptr<RawlogWriter> chunk = std::move(chunk_);
  chunk->close();
  ++chunks_;
  closed_bytes_ += chunk->bytes();
  const auto stampOf = [](const std::optional<Stamp>& stamp) { return stamp ? stamp->ns : 0; };
  note(nlohmann::json{{"chunk", name_},
                      {"entries", chunk->entries()},
                      {"bytes", chunk->bytes()},
                      {"first_stamp_ns", stampOf(first_)},
                      {"last_stamp_ns", stampOf(last_)}}
           .dump());
}

void ChunkedLog::note(const std::string& json) {
  const std::string path = folder_ + "/capture.jsonl", line = json + "\n";
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
  const bool good = file >= 0 &&
                    ::write(file, line.data(), line.size()) == static_cast<ssize_t>(line.size()) &&
                    ::fsync(file) == 0;
  if (file >= 0) ::close(file);
  if (!good) throw OutputError(path + ": cannot be written", ExitCode::kIoError);
}

}  // namespace perception
