#pragma once
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "libperception/core/system/ChildProcess.h"
#include "tests/support/TemporaryFolder.h"

namespace perception::test {

/// What a program that has ended printed (standard output and error) and its exit code; 127 where
/// there is no such program.
struct CommandOutput {
  int code = -1;
  std::string text;
};

/// Runs a program in `folder` (empty: in the test's) without a shell: each word reaches it as it
/// is, also a path with a space.
inline CommandOutput outputOf(const std::vector<std::string>& words,
                              const std::string& folder = "") {
  const TemporaryFolder own;
  ChildCommand command;
  command.words = words;
  command.folder = folder;
  command.output = own / "output";
  ChildProcess process(command);
  process.wait();
  std::ifstream in(command.output, std::ios::binary);
  return {process.exitCode(), std::string(std::istreambuf_iterator<char>(in), {})};
}

}  // namespace perception::test
