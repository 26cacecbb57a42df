#include "libperception/core/CsvStream.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "libperception/core/Error.h"
#include "libperception/core/system/PartialFile.h"

namespace perception {

std::unique_ptr<std::FILE, FileCloser> openTable(const std::string& path) {
  if (const auto what = irregularity(path); !what.empty())
    throw DataError(fmt::format("{}: not a table but {}", path, what));
  std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rbe"));
  if (!file) {
    const ExitCode code = errno == ENOENT ? ExitCode::kNoInput : ExitCode::kBadInput;
    throw DataError(fmt::format("{}: cannot be read: {}", path, std::strerror(errno)), code);
  }
  return file;
}

CsvStream::CsvStream(const std::string& path) : file_(openTable(path)) {
  table_.name_ = path;
  if (!readLine())
    throw DataError(fmt::format("{}:1: empty, expected a header line of column names", path));
  if (line_.substr(0, kTableMark.size()) == kTableMark) line_.remove_prefix(kTableMark.size());
  table_.addRow(line_, number_);
}

bool CsvStream::next() {
  table_.fields_.clear();
  table_.lines_.clear();
  if (!readLine()) return false;
  table_.addRow(line_, number_);
  return true;
}

bool CsvStream::readLine() {
  char* text = buffer_.release();
  const ssize_t length = ::getline(&text, &size_, file_.get());
  buffer_.reset(text);
  if (length < 0 && std::feof(file_.get()) == 0)
    throw DataError(fmt::format("{}: cannot be read: {}", table_.name(), std::strerror(errno)));
  if (length < 0) return false;
  ++number_;
  line_ = {text, static_cast<std::size_t>(length)};
  if (line_.back() != '\n') {
    throw DataError(
        fmt::format("{}:{}: the file ends within this line, expected a line end (was it cut?)",
                    table_.name(), number_));
  }
  line_.remove_suffix(1);
  if (!line_.empty() && line_.back() == '\r') line_.remove_suffix(1);
  return true;
}

}  // namespace perception
