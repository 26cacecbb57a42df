#pragma once
#include <sys/types.h>

#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/support/TemporaryFolder.h"

namespace perception::test {

/// How a program ended.
struct Ending {
  int code = -1;   ///< exit code
  int signal = 0;  ///< that ended it; 0: none
  bool hung = false;
  bool loading = false;  ///< at the blow none of its own code had run: it does not hear signals yet
  double seconds = 0;    ///< that it ran
  std::string said;      ///< standard error
};

/// Calls that fail: the environment of FailingCalls.cpp.
struct FailingCall {
  std::string kind;    ///< write, sync, rename, open, memory; empty: none
  long at = 0;         ///< its number; 0: none, calls are counted
  bool on = false;     ///< all calls from that one on
  std::string report;  ///< file of the numbers of calls
  std::string places;  ///< file of the numbers of the first call from each place
};

/// What is done to a running program.
struct Blow {
  int signal = 0;            ///< 0: nothing
  double after = 0;          ///< [s] from its start
  bool once_loaded = false;  ///< and not before its own code runs
};

/// A program with arguments, in which {in} is the folder of inputs and {out} that of results.
struct Job {
  std::string name;
  std::vector<std::string> words;
  int code = 0;                   ///< with which it ends if nothing is wrong
  std::set<std::string> varying;  ///< results that differ from run to run, within {out}
};

/// Contents of the files below a folder, by name.
using Contents = std::map<std::string, std::string>;
Contents contentsOf(const std::string& folder);

/// Inputs of all jobs: a log of two scans, a run on it, its truth; made once. And what the jobs
/// are.
class Workshop {
 public:
  Workshop();
  const std::vector<Job>& jobs() const { return jobs_; }
  const Job& job(const std::string& name) const;
  /// What the job leaves in an empty folder; made once.
  const Contents& results(const Job& job);
  /// Runs it into `out`; all its processes have ended afterwards.
  Ending run(const Job& job, const std::string& out, const FailingCall& failing = {},
             const Blow& blow = {}) const;
  /// Number of calls of that kind; of the process with most.
  long calls(const Job& job, const std::string& kind) const;
  /// Number of the first call of that kind from each place in any of its processes, in order.
  std::vector<long> firstCalls(const Job& job, const std::string& kind) const;

 private:
  void makeInputs();

  TemporaryFolder folder_;
  std::vector<Job> jobs_;
  std::map<std::string, Contents> results_;
};

/// True if the whole test was asked for: ./setup.sh faults.
bool isWhole();

/// What is wrong in `out`, with results `whole` of an undisturbed run; empty: nothing. Each file is
/// whole or absent; with `complete` none is missing; without `leftovers` there is no other one.
std::string faultIn(const std::string& out, const Job& job, const Contents& whole, bool complete,
                    bool leftovers);

/// The one workshop of the program: its jobs are prepared once.
Workshop& workshop();

}  // namespace perception::test
