#pragma once
#include <cstdio>
#include <memory>
#include <string>
#include <string_view>

#include "libperception/core/system/PartialFile.h"

namespace perception {

/// A checked output file: failures to create, write or close throw OutputError with path, reason
/// and free space. A full disk is detected at the latest in close().
class OutputFile {
 public:
  /// The file has its name after close() and is removed without it; a device is written to as it
  /// is. Throws OutputError (kCannotCreate).
  explicit OutputFile(const std::string& path);

  /// Throws OutputError (kIoError).
  void write(std::string_view text);
  /// Syncs to disk and closes; in a temporary folder whoever makes its files last syncs them.
  /// Throws OutputError (kIoError).
  void close();
  const std::string& path() const { return path_; }

 private:
  [[noreturn]] void fail(int reason) const;
  std::string path_;
  PartialFile partial_;
  std::unique_ptr<std::FILE, FileCloser> file_;
};

/// Creates a folder and its parents; no effect for an empty path. Throws OutputError
/// (kCannotCreate).
void createFolder(const std::string& path);

/// Writes a file. Throws OutputError.
void writeFile(const std::string& path, std::string_view text);

}  // namespace perception
