#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libperception/core/system/Supervision.h"

namespace perception {

/// A result folder whose files are complete or absent: they are written into a hidden folder inside
/// it and renamed into place by commit(). Until then results of an earlier run are unchanged;
/// without commit() all files are removed, and the folder if it was created here. One run at a time
/// writes into a folder (lock on the same host).
class OutputFolder {
 public:
  /// Creates the folder. Throws OutputError (kCannotCreate) with path and reason, Error (kTryAgain)
  /// when another run writes into it.
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Temporary path of the file that commit() renames to `name` (relative; folders are created).
  std::string pathFor(const std::string& name);
  /// Folder in which others write files whose names they choose; adoptAll() makes them its own.
  const std::string& temporary() const { return temporary_; }
  void adoptAll();
  /// A file or folder of an earlier run in it: commit() removes it before the new files come.
  void replace(const std::string& name) { replaced_.push_back(name); }
  /// Syncs all files to disk and renames them into place, `last` as the last one; the `last` of an
  /// earlier run is removed first, so that it never exists beside files of two runs. Throws
  /// OutputError (kIoError), also for a file that was not written.
  void commit(const std::string& last = "done.json");

 private:
  void create();
  void lock();
  void removeLeftovers() const;
  void removeTemporaries() noexcept;
  [[noreturn]] void failWriting(const std::string& path, int reason) const;
  void beginWriting() const;
  void handToDisk(const std::string& path) const;
  void moveIntoPlace(const std::string& name) const;

  std::string path_, temporary_;
  std::optional<TemporaryPath> removed_if_killed_;
  std::vector<std::string> made_;   ///< folders created here, outermost first
  std::vector<std::string> names_;  ///< of the files, in the order of pathFor()
  std::vector<std::string> replaced_;
  int lock_ = -1;  ///< file descriptor of the folder, locked
  bool committed_ = false;
};

}  // namespace perception
