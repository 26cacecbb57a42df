#pragma once
#include <cstdio>
#include <string>

#include "libperception/core/system/Supervision.h"

namespace perception {

/// Closes a file of the C library that a std::unique_ptr holds.
struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// A file that has its name once it is complete: written as path(), renamed by commit(), removed
/// without it. If the name is that of a device or a pipe, this writes to it directly.
class PartialFile {
 public:
  explicit PartialFile(const std::string& name);
  ~PartialFile();
  PartialFile(const PartialFile&) = delete;
  PartialFile& operator=(const PartialFile&) = delete;

  const std::string& path() const { return path_; }
  /// The file is in a folder that is temporary itself: neither needs to be synced yet.
  bool inTemporaryFolder() const { return in_temporary_folder_; }
  /// Syncs the folder; the file itself is synced by whoever writes it. Throws OutputError
  /// (kIoError).
  void commit();

 private:
  std::string name_, path_;
  bool in_temporary_folder_;
  TemporaryPath removed_if_killed_;
  bool pending_ = true;
};

/// What a path is where a regular file was expected: "a directory", "a pipe", ...; empty if it is
/// one, or nothing. Opening a pipe would wait for a writer, for ever.
std::string irregularity(const std::string& path);

}  // namespace perception
