// Each program with each of its calls of the system failing once, or from one on; the whole of it
// by
// ./setup.sh faults, a few calls otherwise.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <numeric>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "libperception/core/Error.h"
#include "tests/faults/Workshop.h"

namespace perception::test {
namespace {

/// 1 ... calls. Of memory, of which a program asks some hundred thousand times, the first call from
/// each place.
std::vector<long> numbersOf(const Job& job, const std::string& kind, long calls) {
  if (!isWhole()) return {(calls + 1) / 2, calls};
  if (kind == "memory") return workshop().firstCalls(job, kind);
  std::vector<long> out(static_cast<std::size_t>(calls));
  std::iota(out.begin(), out.end(), 1L);
  return out;
}

/// What a program may end with when a call of that kind fails.
std::set<int> codesOf(const std::string& kind) {
  if (kind == "memory") return {0, 3, 65, 66, 69, 70, 73, 74, 78};
  return {0, 73, 74};
}

/// Empty, or what is wrong with this job when that call fails.
std::string faultOf(const Job& job, const FailingCall& failing) {
  const TemporaryFolder out;
  const Contents& whole = workshop().results(job);
  const Ending ending = workshop().run(job, out.path(), failing);
  if (ending.hung) return "hangs";
  if (ending.signal != 0) return fmt::format("is ended by signal {}", ending.signal);
  if (codesOf(failing.kind).count(ending.code) == 0)
    return fmt::format("ends with {}: {}", ending.code, ending.said);
  if (ending.code != 0 && ending.said.find(": error: ") == std::string::npos &&
      failing.kind != "memory")
    return fmt::format("ends with {} without a word: {}", ending.code, ending.said);
  const bool done = ending.code == 0 || ending.code == 3;
  if (ending.code == 3 && job.code == 0) {  // a result that says what it lacks
    if (ending.said.find(": warning: ") == std::string::npos) return "warns without a word";
    const Contents there = contentsOf(out.path());
    for (const auto& [name, text] : whole)
      if (there.count(name) == 0) return "ends with 3, " + name + " is missing";
    return "";
  }
  std::string fault = faultIn(out.path(), job, whole, done, false);
  if (!fault.empty()) return fmt::format("ends with {}, {}", ending.code, fault);
  if (done || contentsOf(out.path()).empty()) return "";  // as it was before
  const Ending again = workshop().run(job, out.path());
  fault = faultIn(out.path(), job, whole, true, false);
  if (again.code != job.code || !fault.empty())
    return fmt::format("when run again ends with {}: {}{}", again.code, fault, again.said);
  return "";
}

/// All programs, or two of them; of memory those that do not draw: where OpenGL is refused memory,
/// its software renderer draws less or waits for ever, and says nothing.
std::vector<std::string> programs(bool may_draw) {
  if (!isWhole()) return {"track", "import"};
  std::vector<std::string> names;
  for (const Job& job : workshop().jobs())
    if (may_draw || job.name != "snapshot") names.push_back(job.name);
  return names;
}

class FailingCalls : public testing::TestWithParam<std::tuple<std::string, std::string>> {};

TEST_P(FailingCalls, EndWithACodeOfTheTableAndNoTornFile) {
  const auto& [name, kind] = GetParam();
  const Job& job = workshop().job(name);
  const long calls = workshop().calls(job, kind);
  ASSERT_GT(calls, 0);
  std::size_t runs = 0;
  for (const bool on : {false, true}) {
    if (on && (!isWhole() || (kind != "write" && kind != "sync"))) continue;  // as on a full disk
    for (const long at : numbersOf(job, kind, calls)) {
      ++runs;
      EXPECT_EQ(faultOf(job, {kind, at, on, "", ""}), "")
          << name << ": call " << at << " of " << calls << " (" << kind
          << (on ? ", and all later ones)" : ")");
    }
  }
  if (isWhole())
    std::printf("%s: %ld calls (%s), %zu runs\n", name.c_str(), calls, kind.c_str(), runs);
}

std::string nameOf(const testing::TestParamInfo<std::tuple<std::string, std::string>>& info) {
  return std::get<0>(info.param) + "_" + std::get<1>(info.param);
}

INSTANTIATE_TEST_SUITE_P(OfFiles, FailingCalls,
                         testing::Combine(testing::ValuesIn(programs(true)),
                                          testing::Values("write", "sync", "rename", "open")),
                         nameOf);

INSTANTIATE_TEST_SUITE_P(OfMemory, FailingCalls,
                         testing::Combine(testing::ValuesIn(programs(false)),
                                          testing::Values("memory")),
                         nameOf);

}  // namespace
}  // namespace perception::test
