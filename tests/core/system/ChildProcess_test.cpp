#include "libperception/core/system/ChildProcess.h"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <iterator>

#include "libperception/core/Error.h"
#include "libperception/core/system/MemoryLimit.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {
namespace {

struct Children : testing::Test {
  TemporaryFolder folder;
  ChildCommand shell(const std::string& script) const {
    ChildCommand command;
    command.words = {"sh", "-c", script};
    command.output = folder / "said";
    return command;
  }
  std::string said() const {
    std::ifstream file(folder / "said");
    return {std::istreambuf_iterator<char>(file), {}};
  }
};

TEST_F(Children, RunInTheirFolderWithTheirArguments) {
  ChildCommand command = shell("pwd; echo \"$0\" >&2; exit 7");
  command.words.emplace_back("a b");
  command.folder = "/usr";
  ChildProcess child(command);
  child.wait();
  EXPECT_EQ(child.exitCode(), 7);
  EXPECT_EQ(child.signal(), 0);
  EXPECT_EQ(said(), "/usr\na b\n");
}

TEST_F(Children, ThatAreKilledSayTheSignal) {
  ChildProcess child(shell("kill -KILL $$"));
  child.wait();
  EXPECT_EQ(child.exitCode(), -1);
  EXPECT_EQ(child.signal(), SIGKILL);
  EXPECT_FALSE(child.wasOutOfTime());
}

TEST_F(Children, StopAtTheirTimeLimit) {
  ChildCommand command = shell("exec sleep 100");
  command.seconds = 0.2;
  ChildProcess child(command);
  child.wait();
  EXPECT_TRUE(child.wasOutOfTime());
  EXPECT_EQ(child.signal(), SIGTERM);
  EXPECT_LT(child.seconds(), 3);
}

TEST_F(Children, EndAtTheirLimitOfProcessorTime) {
  ChildCommand command = shell("while :; do :; done");
  command.processor_seconds = 1;
  ChildProcess child(command);
  child.wait();
  EXPECT_EQ(child.signal(), SIGXCPU);
  EXPECT_FALSE(child.wasOutOfTime());
}

TEST_F(Children, KnowTheirMemoryLimit) {
  if (!MemoryLimit::supported()) GTEST_SKIP() << "no memory limit beneath this sanitizer";
  ChildCommand command = shell("ulimit -v");
  command.memory = 1024ULL * 1000000;
  ChildProcess child(command);
  child.wait();
  EXPECT_EQ(said(), "1000000\n");
}

TEST_F(Children, LeaveNoneOfTheirOwnBehind) {
  ChildProcess child(shell("sleep 100 & echo $!"));
  child.wait();
  const pid_t grandchild = std::stoi(said());
  for (int i = 0; i < 100 && ::kill(grandchild, 0) == 0; ++i) ::usleep(20000);
  // A process that has ended keeps its number until its parent has waited for it.
  std::ifstream stat("/proc/" + std::to_string(grandchild) + "/stat");
  std::string number, name, state = "gone";
  stat >> number >> name >> state;
  EXPECT_TRUE(state == "gone" || state == "Z") << state;
}

TEST_F(Children, OfNoProgramOrNoOutputAreErrors) {
  ChildCommand command = shell("");
  command.words = {"no-such-program"};
  ChildProcess child(command);
  child.wait();
  EXPECT_EQ(child.exitCode(), 127);
  command.output = folder / "none/said";
  EXPECT_THROW(ChildProcess{command}, OutputError);
}

}  // namespace
}  // namespace perception::test
