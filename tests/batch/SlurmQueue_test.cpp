#include "libperception/batch/SlurmQueue.h"

#include <cstdlib>

#include "libperception/core/Error.h"
#include "tests/batch/BatchFixture.h"

namespace perception::test {
namespace {

/// A variable of the environment while it lives.
class Variable {
 public:
  Variable(const char* name, const std::string& value) : name_(name) {
    if (const char* before = std::getenv(name)) before_ = before;
    ::setenv(name, value.c_str(), 1);
  }
  ~Variable() { before_ ? ::setenv(name_, before_->c_str(), 1) : ::unsetenv(name_); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  const char* name_;
  std::optional<std::string> before_;
};

/// Scripts stand for Slurm's commands: they keep what they were called with.
struct Queue : BatchFixture {
  Variable path{"PATH", folder.path() + ":" + std::getenv("PATH")};

  void command(const std::string& name, const std::string& script) const {
    const std::string file = folder / name;
    std::ofstream(file) << "#!/bin/sh\nfor word in \"$@\"; do printf '%s|' \"$word\"; done >> "
                        << folder / "calls"
                        << "\necho >> " << folder / "calls" << '\n'
                        << script << '\n';
    std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  }
  SlurmQueue queue() const { return {batch, "/bin/perception-batch", dir}; }
};

TEST_F(Queue, NumbersAreRanges) {
  EXPECT_EQ(arrayRanges({3}), "3");
  EXPECT_EQ(arrayRanges({0, 1, 2, 5, 7, 8}), "0-2,5,7-8");
}

TEST_F(Queue, WordsAreQuoted) { EXPECT_EQ(shellQuoted("a b'c$d"), "'a b'\\''c$d'"); }

TEST_F(Queue, AShardIsATaskOfAnArrayAndReduceComesAfterAny) {
  command("scontrol", "echo 'MaxArraySize            = 1001'");
  command("sbatch", "echo 4$(wc -l < " + (folder / "calls") + ")");
  EXPECT_EQ(queue().submit({5, 0, 1}, {"--partition=p"}, 3),
            (std::vector<std::string>{"42", "43"}));
  const std::string calls = contentOf(folder / "calls");
  EXPECT_NE(calls.find("|--requeue|--array|0-1,5%3|"), std::string::npos) << calls;
  EXPECT_NE(calls.find("|--time|122|"), std::string::npos)
      << calls;  // eight times a quarter of an hour, and a bit
  EXPECT_NE(calls.find("|--partition=p|--wrap|exec '/bin/perception-batch' run -o '" + dir +
                       "' --index $((0 + SLURM_ARRAY_TASK_ID))|"),
            std::string::npos)
      << calls;
  EXPECT_NE(calls.find("|--dependency|afterany:42|"), std::string::npos) << calls;
}

TEST_F(Queue, LargeBatchesAreSeveralArrays) {
  command("scontrol", "echo 'MaxArraySize = 4'");
  command("sbatch", "echo 7");
  queue().submit({1, 4, 5, 9}, {}, 0);
  const std::string calls = contentOf(folder / "calls");
  for (const char* part : {"|--array|1|", "|--array|0-1|", "$((4 + SLURM_ARRAY_TASK_ID))",
                           "$((8 + SLURM_ARRAY_TASK_ID))", "afterany:7:7:7"})
    EXPECT_NE(calls.find(part), std::string::npos) << part << "\n" << calls;
}

TEST_F(Queue, KnowsWhatWaitsAlready) {
  command("squeue", "printf '3 0 Resources\\n1 8 None\\n4 0 launch failed requeued held\\n'");
  EXPECT_EQ(queue().queued(), (std::set<std::size_t>{3, 9}));
}

TEST_F(Queue, SaysWhatSlurmSays) {
  command("squeue", "echo 'slurm_load_jobs error: Unable to contact slurm controller' >&2; exit 1");
  try {
    queue().queued();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::kUnavailable);
    EXPECT_STREQ(error.what(), "squeue: slurm_load_jobs error: Unable to contact slurm controller");
  }
}

}  // namespace
}  // namespace perception::test
