#include "libperception/app/App.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <new>
#include <stdexcept>

#include "libperception/pipeline/output/Progress.h"
#include "tests/config/ConfigFixture.h"

namespace perception::test {
namespace {

/// A program whose run is the test's.
class SmallApp : public App {
 public:
  SmallApp() : App("perception-small", "For tests") {}
  std::function<void(SmallApp&)> body = [](SmallApp&) {};
  void declare(CLI::App& cli) override {
    addConfigOptions(cli, false);
    addInputOption(cli, false);
    addOutputOption(cli, false);
    addRunOptions(cli);
  }
  void run() override { body(*this); }
  using App::configDone;
  using App::loadConfig;
  using App::say;
  using App::warn;
};

/// What a run said and how it ended.
struct RunEnd {
  int code;
  std::string out, err;
};

RunEnd run(SmallApp& app, std::vector<const char*> arguments = {}) {
  arguments.insert(arguments.begin(), "small");
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = runApp(app, static_cast<int>(arguments.size()), arguments.data());
  std::fflush(stdout);
  std::string out = testing::internal::GetCapturedStdout();
  return {code, out, testing::internal::GetCapturedStderr()};
}

RunEnd run(std::function<void(SmallApp&)> body, std::vector<const char*> arguments = {}) {
  SmallApp app;
  app.body = std::move(body);
  return run(app, std::move(arguments));
}

TEST(App, HelpTellsOptionsOfManyValuesFromThoseThatMayBeRepeated) {
  const std::string help = run([](SmallApp&) {}, {"--help"}).out;
  EXPECT_NE(help.find("--input TEXT ... "), std::string::npos) << help;
  EXPECT_NE(help.find("--set TEXT (repeatable) "), std::string::npos) << help;
}

TEST(App, ExceptionsBecomeExitCodesAndOneLine) {
  const std::pair<std::function<void()>, std::pair<int, std::string>> cases[] = {
      {[] {}, {0, ""}},
      {[] { throw DataError("a.rawlog: torn"); }, {65, "a.rawlog: torn"}},
      {[] { throw DataError("a.rawlog: not there", ExitCode::kNoInput); },
       {66, "a.rawlog: not there"}},
      {[] { throw Error(ExitCode::kUnavailable, "no OpenGL"); }, {69, "no OpenGL"}},
      {[] { throw std::runtime_error("odd"); }, {70, "internal: odd"}},
      {[] { throw std::bad_alloc(); }, {70, "internal: out of memory"}},
      {[] { throw 5; }, {70, "internal: an exception of unknown type"}},
      {[] { throw OutputError("out: read-only"); }, {73, "out: read-only"}},
      {[] { throw OutputError("out: full", ExitCode::kIoError); }, {74, "out: full"}},
      {[] { throw Error(ExitCode::kTryAgain, "busy"); }, {75, "busy"}},
      {[] { throw ConfigError("t.ini:1: wrong"); }, {78, "t.ini:1: wrong"}},
  };
  for (const auto& [body, expected] : cases) {
    const RunEnd ended = run([&](SmallApp&) { body(); });
    EXPECT_EQ(ended.code, expected.first);
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(ended.err,
              expected.second.empty() ? "" : "perception-small: error: " + expected.second + "\n");
  }
}

TEST(App, SeveralFaultsStandOneALine) {
  const RunEnd ended = run([](SmallApp&) { throw ConfigError("t.ini:1: x\nt.ini:2: y"); });
  EXPECT_EQ(ended.err, "perception-small: error: several faults:\n  t.ini:1: x\n  t.ini:2: y\n");
}

TEST(App, WarningsEndWithThreeAndAreCountedPerRun) {
  SmallApp app;
  app.body = [](SmallApp& a) { a.warn("two scans lost"); };
  EXPECT_EQ(run(app).code, 3);
  EXPECT_EQ(run(app).err, "perception-small: warning: two scans lost\n");
  EXPECT_EQ(app.warnings(), 1);
  app.body = [](SmallApp&) {};
  EXPECT_EQ(run(app).code, 0);
}

TEST(App, AnErrorAfterWarningsKeepsItsCode) {
  const auto body = [](SmallApp& a) {
    a.warn("w");
    throw DataError("torn");
  };
  EXPECT_EQ(run(body).code, 65);
}

TEST(App, WrongCommandLinesAreUsageErrors) {
  const std::vector<std::vector<const char*>> wrong = {{"--thread", "2"},
                                                       {"--threads", "many"},
                                                       {"--threads", "1.5"},
                                                       {"--threads", "-1"},
                                                       {"--threads"},
                                                       {"stray"},
                                                       {"-c"},
                                                       {"--set"}};
  for (const auto& arguments : wrong) {
    bool ran = false;
    const RunEnd ended = run([&](SmallApp&) { ran = true; }, arguments);
    EXPECT_EQ(ended.code, 64) << arguments[0];
    EXPECT_FALSE(ran);
    EXPECT_EQ(ended.out, "");
    EXPECT_EQ(ended.err.rfind("perception-small: error: ", 0), 0u) << ended.err;
  }
}

TEST(App, OptionsFillTheMembers) {
  SmallApp app;
  const RunEnd ended = run(app, {"-c", "x.ini", "-i", "a", "b", "-o", "out", "--set", "a.b=1",
                                 "--set", "a.c=2", "--threads", "3", "--strict", "-vv"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_EQ(app.config_file, "x.ini");
  EXPECT_EQ(app.inputs, (std::vector<std::string>{"a", "b"}));
  EXPECT_EQ(app.output, "out");
  EXPECT_EQ(app.settings, (std::vector<std::string>{"a.b=1", "a.c=2"}));
  EXPECT_EQ(app.threads, 3);
  EXPECT_TRUE(app.strict);
  EXPECT_EQ(app.verbosity, 2);
}

TEST(App, HelpAndVersionGoToStandardOutputAndEndWell) {
  const RunEnd help = run([](SmallApp&) { FAIL(); }, {"--help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_NE(help.out.find("--print-config"), std::string::npos);
  EXPECT_EQ(help.err, "");
  const RunEnd version = run([](SmallApp&) { FAIL(); }, {"--version"});
  EXPECT_EQ(version.code, 0);
  EXPECT_EQ(version.out.rfind("perception-small ", 0), 0u) << version.out;
}

TEST(App, SaysOnlyWhatTheVerbosityAllows) {
  const auto body = [](SmallApp& a) {
    a.say(0, "always");
    a.say(1, "more");
    a.say(2, "most");
  };
  EXPECT_EQ(run(body).err, "always\n");
  EXPECT_EQ(run(body, {"-v"}).err, "always\nmore\n");
}

void readAll(SmallApp& app) {
  Config config = app.loadConfig();
  config.read<AllKinds>("a");
  if (app.configDone(config)) return;
  throw DataError("went on");
}

TEST(AppConfig, IsPrintedAndNothingElseHappens) {
  const TemporaryFolder folder;
  const std::string path = folder / "site.ini";
  writeText(path, "[a]\ngain = 1\n");
  const RunEnd ended = run(readAll, {"-c", path.c_str(), "--set", "a.beams=7", "--print-config"});
  EXPECT_EQ(ended.code, 0) << ended.err;
  EXPECT_NE(ended.out.find("\ngain = 1 "), std::string::npos);
  EXPECT_NE(ended.out.find("\nbeams = 7 "), std::string::npos);
  EXPECT_EQ(run(readAll, {"-c", path.c_str()}).code, 65);  // without it the run goes on
}

TEST(AppConfig, FaultsEndWithSeventyEight) {
  const TemporaryFolder folder;
  const std::string path = folder / "site.ini";
  const RunEnd missing = run(readAll, {"-c", path.c_str()});
  EXPECT_EQ(missing.code, 78);
  EXPECT_EQ(missing.err,
            "perception-small: error: " + path + ": cannot be read: No such file or directory\n");
  writeText(path, "[a]\ngain = 1,5\n");
  const RunEnd wrong = run(readAll, {"-c", path.c_str(), "--set", "a.b", "--print-config"});
  EXPECT_EQ(wrong.code, 78);
  EXPECT_EQ(wrong.out, "");
  EXPECT_NE(wrong.err.find(path + ":2: [a] gain: found '1,5'"), std::string::npos);
  EXPECT_NE(wrong.err.find("--set a.b: expected section.key=value"), std::string::npos);
}

class AppSignal : public ::testing::TestWithParam<std::pair<int, const char*>> {};

TEST_P(AppSignal, StopsTheRunAtTheNextFrame) {
  const auto [number, title] = GetParam();
  int frames = 0;
  const RunEnd ended = run([&, signal = number](SmallApp&) {
    for (;; ++frames) {
      stopIfAsked();
      if (frames == 3) std::raise(signal);
    }
  });
  EXPECT_EQ(ended.code, 75);
  EXPECT_EQ(frames, 4);
  EXPECT_EQ(ended.err, std::string("perception-small: error: stopped by ") + title + "\n");
  EXPECT_EQ(run([](SmallApp&) { EXPECT_FALSE(stopAsked()); }).code, 0);  // the next run starts anew
}

INSTANTIATE_TEST_SUITE_P(Both, AppSignal,
                         ::testing::Values(std::pair(SIGINT, "SIGINT"),
                                           std::pair(SIGTERM, "SIGTERM")));

TEST(AppSignal, TheSecondOneKills) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        SmallApp app;
        app.body = [](SmallApp&) {
          std::raise(SIGTERM);
          std::raise(SIGINT);
        };
        const char* argv[] = {"small"};
        runApp(app, 1, argv);
      },
      testing::KilledBySignal(SIGINT), "");
}

TEST(App, AFullDiskBehindStandardOutputIsAnIoError) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  for (const std::size_t bytes : {10u, 1'000'000u}) {  // seen at the end, seen while printing
    EXPECT_EXIT(
        {
          SmallApp app;
          app.body = [&](SmallApp&) { fmt::print("{}", std::string(bytes, 'x')); };
          if (!std::freopen("/dev/full", "w", stdout)) std::exit(1);
          const char* argv[] = {"small"};
          std::exit(runApp(app, 1, argv));
        },
        testing::ExitedWithCode(74), "cannot (be written|write)");
  }
}

TEST(Progress, IsSilentWhereNoTerminalIs) {
  testing::internal::CaptureStderr();
  {
    Progress progress("log", 100);
    for (int i = 0; i < 100; ++i) progress.update(static_cast<std::uint64_t>(i), 5);
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace perception::test
