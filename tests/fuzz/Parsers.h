#pragma once
#include <functional>
#include <string_view>
#include <vector>

namespace perception {

/// A parser of files of others, on bytes. It may refuse them with an Error of ours and do nothing
/// else.
struct Parser {
  const char* name;
  std::function<void(std::string_view)> run;
};

/// All but those whose libraries are known to fail on bad bytes and which the programs therefore
/// read within a ReadingScope: rawlogs (MRPT allocates what a length in the file says; their bytes
/// are changed in tests/sensors/rawlog/RawlogReader_test.cpp), part models (matio,
/// OpenCV), networks and images.
const std::vector<Parser>& parsers();

/// Calls it; all other exceptions than an Error pass.
void parse(const Parser& parser, std::string_view bytes);

}  // namespace perception
