#pragma once
#include <string>
#include <vector>

namespace perception::python {

/// Runs the class of perception-NAME (track, evaluate, simulate) with the arguments of its command
/// line, as the program does; returns its number of warnings. Errors are thrown; SIGINT and SIGTERM
/// end it as stopped by Error (kTryAgain). One program at a time runs in a process.
int runProgram(const std::string& name, std::vector<std::string> arguments);

}  // namespace perception::python
