// Programs that are killed or stopped at any instant. Number of blows: PERCEPTION_FAULTS=all.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <map>
#include <random>

#include "tests/faults/Workshop.h"

namespace perception::test {
namespace {

constexpr unsigned kSeed = 20;

/// [s] that the job takes: the shorter of two runs, for the first one may have to read its program
/// and libraries from the disk, and blows after its length would come too late.
double lengthOf(const Job& job) {
  static std::map<std::string, double> known;
  if (known.count(job.name) == 0) {
    double shorter = 1e9;
    for (int i = 0; i < 2; ++i) {
      const TemporaryFolder out;
      shorter = std::min(shorter, workshop().run(job, out.path()).seconds);
    }
    known[job.name] = shorter;
  }
  return known.at(job.name);
}

/// Blows at random instants of random jobs.
std::vector<std::pair<const Job*, Blow>> blowsOf(int signal, int number) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> when(0, 1.1);
  std::vector<std::pair<const Job*, Blow>> out;
  const auto& jobs = workshop().jobs();
  for (int i = 0; i < number; ++i) {
    const Job& job = jobs[static_cast<std::size_t>(i) % jobs.size()];
    out.emplace_back(&job, Blow{signal, when(random) * lengthOf(job), false});
  }
  return out;
}

TEST(Signals, AKilledProgramLeavesWholeFilesAndTheNextRunTidiesUp) {
  const int wanted = isWhole() ? 200 : 2;
  int killed = 0, left = 0;
  for (const auto& [job, blow] : blowsOf(SIGKILL, 4 * wanted)) {  // some are faster
    if (killed == wanted) break;
    SCOPED_TRACE(fmt::format("{} killed after {:.3f} s", job->name, blow.after));
    const TemporaryFolder out;
    const Contents& whole = workshop().results(*job);
    const Ending ending = workshop().run(*job, out.path(), {}, blow);
    EXPECT_FALSE(ending.hung);
    killed += ending.signal == SIGKILL;
    EXPECT_EQ(faultIn(out.path(), *job, whole, false, true), "");
    left += faultIn(out.path(), *job, whole, false, false).empty() ? 0 : 1;
    const Ending again = workshop().run(*job, out.path());
    EXPECT_EQ(again.code, job->code) << again.said;
    EXPECT_EQ(faultIn(out.path(), *job, whole, true, false), "") << "after the next run";
  }
  EXPECT_EQ(killed, wanted);
  if (isWhole()) std::printf("%d were killed, %d left temporary files\n", killed, left);
}

TEST(Signals, AProgramHearsThemFromItsFirstInstructionOn) {
  const TemporaryFolder out;
  const Ending ending = workshop().run(workshop().job("track"), out.path(), {}, {SIGTERM, 0, true});
  EXPECT_EQ(ending.code, 75) << "signal " << ending.signal;
  EXPECT_NE(ending.said.find("stopped by SIGTERM"), std::string::npos) << ending.said;
  EXPECT_TRUE(contentsOf(out.path()).empty());
}

TEST(Signals, AStoppedProgramEndsWith75AndLeavesNothing) {
  int blows = 0, stopped = 0, loading = 0;
  for (const auto& [job, blow] : blowsOf(SIGTERM, isWhole() ? 200 : 20)) {
    if (!isWhole() && blows >= 4 && stopped + loading > 0) break;  // the first ones may be too late
    ++blows;
    SCOPED_TRACE(fmt::format("{} stopped after {:.3f} s", job->name, blow.after));
    const TemporaryFolder out;
    const Contents& whole = workshop().results(*job);
    const Ending ending = workshop().run(*job, out.path(), {}, blow);
    if (ending.code == job->code) {  // it was faster
      EXPECT_EQ(faultIn(out.path(), *job, whole, true, false), "");
      continue;
    }
    // No code of ours has run, nothing has begun: the shell's 143.
    const bool unheard = ending.loading && ending.signal == SIGTERM;
    ++(unheard ? loading : stopped);
    if (!unheard) {
      EXPECT_EQ(ending.code, 75) << "signal " << ending.signal << " " << ending.said;
    }
    EXPECT_EQ(faultIn(out.path(), *job, whole, false, false), "");
  }
  EXPECT_GT(stopped + loading, 0);
  if (isWhole())
    std::printf("%d of 200 were stopped, %d before they were loaded\n", stopped, loading);
}

}  // namespace
}  // namespace perception::test
