// Parsers on bytes that a fuzzer makes (libFuzzer, with sanitizers). One program: FUZZ_TARGET=NAME
// perception_fuzz [libFuzzer's options] [CORPUS]. Run by ./setup.sh fuzz MINUTES.
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "libperception/sensors/observations/registerClasses.h"
#include "tests/fuzz/Parsers.h"

namespace perception {
namespace {

/// Without one the names of all, and the end.
const Parser* chosen() {
  const char* name = std::getenv("FUZZ_TARGET");
  for (const Parser& parser : parsers()) {
    if (name == nullptr) std::printf("%s\n", parser.name);
    if (name != nullptr && std::string_view(name) == parser.name) return &parser;
  }
  std::exit(name == nullptr ? 0 : 64);
}

const Parser* target = nullptr;

}  // namespace
}  // namespace perception

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  perception::target = perception::chosen();
  perception::registerPerceptionClasses();
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const unsigned char* data, std::size_t size) {
  perception::parse(*perception::target, {reinterpret_cast<const char*>(data), size});
  return 0;
}
