#pragma once
#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace perception {

/// What a process is started with.
struct ChildCommand {
  std::vector<std::string> words;  ///< program, looked up on PATH if it has no '/', and arguments
  std::string folder;              ///< working folder; empty: that of this process
  /// File of standard output and error; empty: both to this process's standard error. Standard
  /// input is empty.
  std::string output;
  std::uint64_t memory = 0;  ///< [bytes] of address space (RLIMIT_AS); 0: as this process
  /// [s] of processor time of each of its processes, at which it is ended by SIGXCPU (RLIMIT_CPU);
  /// 0: as this process
  std::uint64_t processor_seconds = 0;
  double seconds = 0;  ///< it is stopped after as long; 0: never
};

/// A process that runs another program beside this one, with a limit of memory and time. It is
/// asked to stop by SIGTERM, and killed with all its descendants of its process group a few seconds
/// later. It does not outlive this object, and is asked to stop when this process dies.
class ChildProcess {
 public:
  static constexpr double kGrace = 3.5;  ///< [s] from SIGTERM to SIGKILL

  /// Throws OutputError for the output file, Error (kUnavailable) where no process can be started.
  explicit ChildProcess(const ChildCommand& command);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  /// Looks after it without waiting; false once it has ended.
  bool running();
  void stop();
  /// Returns once it has ended.
  void wait();

  // Of a process that has ended.
  int exitCode() const { return code_; }  ///< 127: no such program; -1: ended by a signal
  int signal() const { return signal_; }  ///< that ended it; 0: none
  bool wasOutOfTime() const { return out_of_time_; }
  bool wasStopped() const { return stopped_ > 0 && !out_of_time_; }  ///< by stop()
  double seconds() const { return seconds_; }                        ///< [s] that it ran

 private:
  pid_t process_ = -1;
  double limit_ = 0, started_ = 0, stopped_ = 0, seconds_ = 0;  // [s]
  int code_ = -1, signal_ = 0;
  bool out_of_time_ = false, ended_ = false;
};

}  // namespace perception
