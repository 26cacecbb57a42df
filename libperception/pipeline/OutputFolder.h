#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace perception {

/// A folder of results whose files are whole or absent: they are written into a dot folder
/// inside it and renamed into place by commit(). Until then results of an earlier run stay as they
/// are; without commit() nothing is left, the folder itself included when it was made here. One run
/// at a time writes into a folder (lock of the same host).
class OutputFolder {
 public:
  /// Creates the folder. Throws OutputError (kCannotCreate) with path and reason, Error (kTryAgain)
  /// when another run writes into it.
  explicit OutputFolder(const std::string& path);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  const std::string& path() const { return path_; }
  /// Where to write the file that will be `name` (relative; may hold folders, which are made).
  std::string pathFor(const std::string& name);
  /// Hands all files to the disk and renames them into place, `last` as the last; an earlier `last`
  /// is removed first, so that it never stands beside files of two runs. Throws OutputError
  /// (kIoError) also for a file that was never written.
  void commit(const std::string& last = "done.json");

 private:
  void create();
  void lock();
  void removeLeftovers() const;
  void removeTemporaries() noexcept;
  [[noreturn]] void failWriting(const std::string& path, int reason) const;
  void handToDisk(const std::string& path) const;
  void moveIntoPlace(const std::string& name) const;

  std::string path_, temporary_;
  std::vector<std::string> made_;   ///< folders made here, outermost first
  std::vector<std::string> names_;  ///< files promised, in the order of pathFor()
  int lock_ = -1;                   ///< the folder's descriptor, locked
  bool committed_ = false;
};

}  // namespace perception
