#include "libperception/app/Supervisor.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

#include "libperception/app/App.h"
#include "libperception/core/system/Supervision.h"
#include "libperception/pipeline/output/OutputFolder.h"
#include "libperception/pipeline/output/Progress.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

class SupervisedApp : public App {
 public:
  SupervisedApp() : App("perception-small", "For tests") {}
  std::function<void()> body;
  void declare(CLI::App&) override {}
  void run() override { body(); }
};

struct SupervisedEnd {
  int code;
  std::string err;
};

/// In a process of its own: a program's child returns from runSupervised(), too.
SupervisedEnd run(std::function<void()> body, SupervisorLimits limits = {}) {
  SupervisedApp app;
  app.body = std::move(body);
  testing::internal::CaptureStderr();
  const pid_t process = ::fork();
  if (process == 0) {
    const char* argv[] = {"perception-small"};
    const int code = runSupervised(app, 1, argv, limits);
    std::fflush(nullptr);
    ::_exit(code);
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status),
          testing::internal::GetCapturedStderr()};
}

/// As a library that stumbles over the byte 77 of a file.
std::function<void()> reading(std::function<void()> what) {
  return [what = std::move(what)] {
    const ReadingScope scope("x.rawlog", 77);
    what();
  };
}

void crash() { ::raise(SIGSEGV); }
void hang() {
  for (volatile unsigned i = 0;; i = i + 1) {
  }
}

TEST(Supervisor, PassesOnHowTheProgramEnds) {
  EXPECT_EQ(run([] {}).code, 0);
  const SupervisedEnd ended = run([] { throw DataError("a.rawlog: torn"); });
  EXPECT_EQ(ended.code, 65);
  EXPECT_EQ(ended.err, "perception-small: error: a.rawlog: torn\n");
}

TEST(Supervisor, ACrashOnDataOfOthersIsBadInputWithItsPlace) {
  const SupervisedEnd ended = run(reading(crash));
  EXPECT_EQ(ended.code, 65);
  EXPECT_NE(ended.err.find("x.rawlog: damaged: reading what begins at byte 77 ended the program"),
            std::string::npos)
      << ended.err;
}

TEST(Supervisor, ALibraryThatEndsTheProcessOnDataOfOthersMakesItBadInput) {
  const SupervisedEnd ended = run(reading([] { std::_Exit(1); }));
  EXPECT_EQ(ended.code, 65);
  EXPECT_NE(ended.err.find("with code 1"), std::string::npos) << ended.err;
}

TEST(Supervisor, ReadingThatDoesNotEndIsStopped) {
  const SupervisedEnd ended = run(reading(hang), {0.5, 4.5});
  EXPECT_EQ(ended.code, 65);
  EXPECT_NE(ended.err.find("byte 77 does not end"), std::string::npos) << ended.err;
}

TEST(Supervisor, ManyEntriesThatTakeTheirTimeTogetherAreNoHang) {
  const auto slow = [] {
    for (int i = 0; i < 8; ++i) {
      const ReadingScope scope("x.rawlog", 77);
      const std::clock_t end = std::clock() + CLOCKS_PER_SEC / 4;
      while (std::clock() < end) {
      }
    }
  };
  EXPECT_EQ(run(slow, {1, 4.5}).code, 0);
}

TEST(Supervisor, ACrashElsewhereIsInternal) {
  EXPECT_EQ(run(crash).code, 70);
  EXPECT_EQ(run([] { std::_Exit(1); }).code, 70);
  EXPECT_EQ(run([] { std::terminate(); }).code, 70);
}

TEST(Supervisor, AProgramThatSomebodyKillsMayBeTriedAgain) {
  EXPECT_EQ(run(reading([] { ::raise(SIGKILL); })).code, 75);
  EXPECT_EQ(run([] { ::raise(SIGKILL); }).code, 75);
}

TEST(Supervisor, NothingTemporaryIsLeftOfAProgramThatCrashed) {
  const TemporaryFolder folder;
  EXPECT_EQ(run([&] {
              OutputFolder out(folder / "out");
              std::ofstream(out.pathFor("tracks.csv")) << "half";
              crash();
            }).code,
            70);
  std::size_t files = 0;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
    files += !entry.is_directory();
  EXPECT_EQ(files, 0U);
  EXPECT_FALSE(std::filesystem::exists(folder / "out/done.json"));
}

TEST(Supervisor, AStopSignalIsPassedOn) {
  const SupervisedEnd ended = run([] {
    ::kill(::getppid(), SIGTERM);
    for (;;) stopIfAsked();
  });
  EXPECT_EQ(ended.code, 75);
  EXPECT_EQ(ended.err, "perception-small: error: stopped by SIGTERM\n");
}

TEST(Supervisor, AProgramThatDoesNotHearTheSignalIsKilledInTime) {
  const SupervisedEnd ended = run(
      [] {
        ::kill(::getppid(), SIGINT);
        hang();
      },
      {20, 0.5});
  EXPECT_EQ(ended.code, 75);
  EXPECT_EQ(ended.err, "perception-small: error: stopped by SIGINT\n");
}

TEST(Supervisor, AClosedStandardErrorChangesNothing) {
  const TemporaryFolder folder;
  const auto body = [&] {
    std::ofstream(folder / "result") << "whole";
    throw DataError("not shown");
  };
  const SupervisedEnd ended = run([] {});
  ASSERT_EQ(ended.code, 0);
  SupervisedApp app;
  app.body = body;
  const pid_t process = ::fork();
  if (process == 0) {
    ::close(STDERR_FILENO);
    const char* argv[] = {"perception-small"};
    ::_exit(runSupervised(app, 1, argv));
  }
  int status = 0;
  ::waitpid(process, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 65);
  std::ifstream in(folder / "result");
  std::string text;
  in >> text;
  EXPECT_EQ(text, "whole") << "no message goes to a file that got the number of standard error";
}

}  // namespace
}  // namespace perception::test
