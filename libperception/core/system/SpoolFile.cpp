#include "libperception/core/system/SpoolFile.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>

#include "libperception/core/Error.h"

namespace perception {
namespace {

std::string spoolPlaceOf(const std::string& output, const std::string& name) {
  if (irregularity(output).empty()) return fmt::format("{}.{}", output, name);
  return (std::filesystem::temp_directory_path() / fmt::format("perception.{}", name)).string();
}

[[noreturn]] void failSpool(const std::string& path) {
  throw OutputError(
      fmt::format("{}: cannot be written: {}", path, std::strerror(errno ? errno : EIO)),
      ExitCode::kIoError);
}

}  // namespace

SpoolFile::SpoolFile(const std::string& output, const std::string& name)
    : place_(spoolPlaceOf(output, name)), file_(std::fopen(place_.path().c_str(), "w+be")) {
  if (!file_) {
    throw OutputError(
        fmt::format("{}: cannot be created: {}", place_.path(), std::strerror(errno)));
  }
}

void SpoolFile::write(std::string_view text) {
  errno = 0;
  if (std::fwrite(text.data(), 1, text.size(), file_.get()) != text.size())
    failSpool(place_.path());
}

void SpoolFile::copyTo(const TextSink& sink) {
  errno = 0;
  if (std::fflush(file_.get()) != 0 || std::fseek(file_.get(), 0, SEEK_SET) != 0)
    failSpool(place_.path());
  char block[1 << 16];
  std::size_t count = 0;
  while ((count = std::fread(block, 1, sizeof block, file_.get())) > 0) sink({block, count});
  if (std::ferror(file_.get()) != 0) failSpool(place_.path());
}

}  // namespace perception
