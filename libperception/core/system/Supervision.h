#pragma once
#include <sys/types.h>

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace perception {

/// What a process tells its supervisor (app/Supervisor.h) through shared memory: what it is
/// reading, and which temporary files it has, since it cannot remove them when it is killed.
/// Without a supervisor the record belongs to the process alone, and nothing reads it.
struct SupervisionRecord {
  static constexpr std::size_t kMostPaths = 64, kLongestPath = 4096;

  std::atomic<std::uint64_t> reading{0};   ///< counts ReadingScopes: odd inside of one
  std::atomic<std::uint64_t> position{0};  ///< [bytes] in what is read
  std::array<char, kLongestPath> read_from{};
  std::array<std::array<char, kLongestPath>, kMostPaths> temporaries{};  ///< empty: a free place

  static SupervisionRecord& ofThisProcess();
  /// Replaces the record; before the first use. Not owned.
  static void set(SupervisionRecord* record);
};

/// Marks that a library is parsing foreign data, on which it may crash, hang or end the process.
/// One counts at a time: those inside another have no effect. For one thread.
class ReadingScope {
 public:
  explicit ReadingScope(const std::string& path, std::uint64_t position = 0);
  ~ReadingScope();
  ReadingScope(const ReadingScope&) = delete;
  ReadingScope& operator=(const ReadingScope&) = delete;

 private:
  bool outer_ = false;
};

/// A file or folder that is to go away if this process is killed.
class TemporaryPath {
 public:
  /// `path` is not created; empty: none.
  explicit TemporaryPath(const std::string& path);
  ~TemporaryPath();
  TemporaryPath(const TemporaryPath&) = delete;
  TemporaryPath& operator=(const TemporaryPath&) = delete;

  /// True if `path` lies in a folder that is one: whoever makes the folder's files last syncs them.
  static bool holds(const std::string& path);

 private:
  std::size_t place_;
};

/// ".NAME.HOST.PID.part" beside `path`: a file of this name is renamed to `path` once it is
/// complete. Removes what killed processes of this host left in the folder, once.
std::string partialPath(const std::string& path);

/// True if a process of that number of this host has not ended, waited for or not.
bool isAlive(pid_t process);
std::string hostName();

}  // namespace perception
