#pragma once
#include <memory>
#include <string>

#include "libperception/core/system/Supervision.h"
#include "libperception/interop/bags/ReadingBag.h"

namespace perception {

/// The content of a zstd file, as a file in the folder of temporary files; gone with this, or with
/// the process.
class InflatedFile {
 public:
  /// Throws DataError (missing, empty), OutputError (no space).
  explicit InflatedFile(const std::string& path);
  ~InflatedFile();
  InflatedFile(const InflatedFile&) = delete;
  InflatedFile& operator=(const InflatedFile&) = delete;

  const std::string& path() const { return path_; }
  /// What was wrong with the zstd file, whose content then ends early; empty: nothing.
  const std::string& fault() const { return fault_; }

 private:
  void fill(const std::string& from, int to);

  std::string path_, fault_;
  std::unique_ptr<TemporaryPath> removed_if_killed_;
};

/// A recording whose bytes are in `file`; what is wrong with that comes first among its faults.
std::unique_ptr<ReadingBag> insideBag(const std::string& path, std::unique_ptr<ReadingBag> bag,
                                      std::unique_ptr<InflatedFile> file);

}  // namespace perception
