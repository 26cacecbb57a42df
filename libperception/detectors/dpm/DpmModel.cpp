#include "libperception/detectors/dpm/DpmModel.h"

#include <fmt/format.h>
#include <zlib.h>

#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>

#include "libperception/core/Error.h"
#include "libperception/detectors/dpm/DpmMatFile.h"
#include "libperception/detectors/simd/VisionKernels.h"

namespace perception {
namespace {

constexpr int kLargest = 64;  // [cells] side of a filter, components, parts
constexpr std::size_t kMostBytes = 1UL << 28;

/// Words of a text with their line numbers.
class Words {
 public:
  Words(const std::string& text, std::string name) : text_(text), name_(std::move(name)) {}

  [[noreturn]] void fail(const std::string& expected) const {
    throw DataError(fmt::format("{}:{}: expected {}", name_, line_, expected));
  }
  bool atEnd() {
    skipSpace();
    return place_ >= text_.size();
  }
  std::string word(const char* expected) {
    if (atEnd()) fail(expected);
    const std::size_t begin = place_;
    while (place_ < text_.size() && !isSpace(text_[place_])) ++place_;
    return text_.substr(begin, place_ - begin);
  }
  void key(const char* key) {
    if (word(key) != key) fail(fmt::format("'{}'", key));
  }
  /// Consumes the word if it is next.
  bool has(const std::string& word) {
    if (atEnd() || text_.compare(place_, word.size(), word) != 0) return false;
    place_ += word.size();
    return true;
  }
  double real(const char* expected) {
    if (atEnd()) fail(expected);
    double value = 0;
    const auto [end, error] =
        std::from_chars(text_.data() + place_, text_.data() + text_.size(), value);
    if (error != std::errc() || !std::isfinite(value)) fail(expected);
    place_ = static_cast<std::size_t>(end - text_.data());
    if (place_ < text_.size() && !isSpace(text_[place_])) fail(expected);
    return value;
  }
  int whole(const char* expected, int low, int high) {
    const double value = real(expected);
    if (value < low || value > high || value != std::floor(value))
      fail(fmt::format("{} from {} to {}", expected, low, high));
    return static_cast<int>(value);
  }

 private:
  static bool isSpace(char c) { return c == ' ' || c == '\n' || c == '\r' || c == '\t'; }
  void skipSpace() {
    for (; place_ < text_.size(); ++place_) {
      const char c = text_[place_];
      if (c == '#') {
        while (place_ + 1 < text_.size() && text_[place_ + 1] != '\n') ++place_;
      } else if (!isSpace(c)) {
        return;
      }
      if (c == '\n') ++line_;
    }
  }
  const std::string& text_;
  std::string name_;
  std::size_t place_ = 0;
  int line_ = 1;
};

DpmFilter readFilter(Words& in) {
  DpmFilter filter;
  in.key("size_hw");
  filter.height = in.whole("height of the filter", 1, kLargest);
  filter.width = in.whole("width of the filter", 1, kLargest);
  in.key("dims");
  in.whole("32 features a cell", kHogFeatures, kHogFeatures);
  return filter;
}

void readWeights(Words& in, DpmFilter& filter) {
  filter.weights.resize(static_cast<std::size_t>(filter.height * filter.width * kHogFeatures));
  for (float& w : filter.weights) w = static_cast<float>(in.real("a weight"));
}

DpmPart readPart(Words& in, int number) {
  DpmPart part;
  in.key("part");
  in.whole("number of the part", number, number);
  in.key("anchor_xyl");
  part.anchor_x = in.whole("anchor's column", -kLargest, 2 * kLargest);
  part.anchor_y = in.whole("anchor's row", -kLargest, 2 * kLargest);
  in.whole("1 (twice the root's resolution)", 1, 1);
  part.filter = readFilter(in);
  in.key("def");
  for (double& d : part.deformation) d = in.real("a cost of displacement");
  readWeights(in, part.filter);
  return part;
}

DpmComponent readComponent(Words& in, int number) {
  DpmComponent c;
  in.key("component");
  in.whole("number of the component", number, number);
  in.key("alpha_rad");
  c.heading = in.real("an angle");
  in.key("offset");
  c.offset = in.real("an offset");
  if (in.has("octaves")) {
    for (double& o : c.octaves) o = in.real("an offset of an octave");
  }
  in.key("detwindow_hw");
  c.height = in.whole("height of the window", 1, kLargest);
  c.width = in.whole("width of the window", 1, kLargest);
  in.key("parts");
  const int parts = in.whole("number of parts", 0, kLargest);
  in.key("root");
  in.key("anchor_xyl");
  for (int i = 0; i < 3; ++i) in.whole("0", 0, 0);
  c.root = readFilter(in);
  readWeights(in, c.root);
  for (int p = 1; p <= parts; ++p) c.parts.push_back(readPart(in, p));
  return c;
}

std::string fileText(const std::string& path) {
  if (!std::filesystem::exists(path))
    throw DataError(fmt::format("{}: no such file (a bank of part models)", path),
                    ExitCode::kNoInput);
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> file(gzopen(path.c_str(), "rb"), &gzclose);
  if (!file) throw DataError(fmt::format("{}: cannot be read", path));
  std::string text;
  for (std::vector<char> part(1U << 20); text.size() < kMostBytes;) {
    const int count = gzread(file.get(), part.data(), static_cast<unsigned>(part.size()));
    if (count < 0) throw DataError(fmt::format("{}: damaged gzip data", path));
    if (count == 0) break;
    text.append(part.data(), static_cast<std::size_t>(count));
  }
  return text;
}

}  // namespace

DpmModel parseDpmModel(const std::string& text, const std::string& name) {
  Words in(text, name);
  DpmModel model;
  in.key("class");
  model.class_name = in.word("a class name");
  in.key("components");
  const int components = in.whole("number of components", 1, kLargest);
  in.key("sbin");
  model.cell = in.whole("side of a cell", 4, 16);
  in.key("interval");
  in.whole("levels an octave", 1, 100);
  in.key("thresh");
  model.threshold = in.real("a threshold");
  for (int k = 0; k < components; ++k) model.components.push_back(readComponent(in, k));
  if (!in.atEnd()) in.fail("nothing behind the last component");
  model.has_heading = true;
  return model;
}

DpmModel readDpmModel(const std::string& path) {
  if (std::filesystem::path(path).extension() == ".mat") return readDpmMatFile(path);
  return parseDpmModel(fileText(path), path);
}

}  // namespace perception
