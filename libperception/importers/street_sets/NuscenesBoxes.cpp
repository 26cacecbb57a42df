#include "libperception/importers/street_sets/NuscenesBoxes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>

#include "libperception/core/Error.h"
#include "libperception/importers/ImportText.h"

namespace perception {
namespace {

using nlohmann::json;

constexpr int kSampleDepth = 2, kBoxDepth = 3;  // of {"results": {SAMPLE: [{box}]}}
constexpr std::size_t kMostJsonBytes = std::size_t{1} << 30;
constexpr std::size_t kMostDigits = 9;

/// Characters of a text; counts the lines that were read, for messages.
class CountingIterator {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  CountingIterator(const char* at, std::size_t& line) : at_(at), line_(&line) {}
  const char& operator*() const { return *at_; }
  CountingIterator& operator++() {
    if (*at_ == '\n') ++*line_;
    ++at_;
    return *this;
  }
  bool operator==(const CountingIterator& other) const { return at_ == other.at_; }
  bool operator!=(const CountingIterator& other) const { return at_ != other.at_; }

 private:
  const char* at_;
  std::size_t* line_;
};

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  std::vector<WorldBox> read() {
    const std::string text = readBytes(path_, kMostJsonBytes);
    const auto use = [&](int depth, json::parse_event_t event, json& parsed) {
      return take(depth, event, parsed);
    };
    json rest;  // what was not used
    try {
      rest = json::parse(CountingIterator(text.data(), line_),
                         CountingIterator(text.data() + text.size(), line_), use);
    } catch (const json::exception& e) {
      fail(fmt::format("not JSON: {}", e.what()));
    }
    if (!has_results_ || !rest.is_object())
      throw DataError(path_ + ": no member 'results', expected nuScenes' detection results");
    return std::move(boxes_);
  }

 private:
  /// False: the value is not kept, as it was used.
  bool take(int depth, json::parse_event_t event, json& parsed) {
    if (event == json::parse_event_t::key && depth == 1) {
      in_results_ = parsed == "results";
      has_results_ = has_results_ || in_results_;
    }
    if (!in_results_) return true;
    if (event == json::parse_event_t::key && depth == kSampleDepth)
      frame_ = frameOf(parsed.get<std::string>());
    const bool ends = event == json::parse_event_t::value ||
                      event == json::parse_event_t::array_end ||
                      event == json::parse_event_t::object_end;
    if (!ends) return true;
    if (depth == 1 && !parsed.is_object())
      fail("results: expected an object of samples, each a list of boxes");
    if (depth == kSampleDepth && !parsed.is_array()) fail("a sample: expected a list of boxes");
    if (depth != kBoxDepth) return true;
    boxes_.push_back(boxOf(parsed));
    return false;
  }

  std::int64_t frameOf(const std::string& sample) const {
    const bool number = !sample.empty() && sample.size() <= kMostDigits &&
                        std::all_of(sample.begin(), sample.end(),
                                    [](unsigned char c) { return std::isdigit(c) != 0; });
    if (!number) fail(fmt::format("sample '{}': expected the number of its frame", sample));
    return std::stoll(sample);
  }

  template <std::size_t N>
  std::array<double, N> numbers(const json& box, const char* key) const {
    std::array<double, N> out{};
    const bool good = box.contains(key) && box[key].is_array() && box[key].size() == N &&
                      std::all_of(box[key].begin(), box[key].end(), [](const json& v) {
                        return v.is_number() && std::isfinite(v.get<double>());
                      });
    if (!good) fail(fmt::format("{}: expected {} numbers", key, N));
    std::transform(box[key].begin(), box[key].end(), out.begin(),
                   [](const json& v) { return v.get<double>(); });
    return out;
  }

  WorldBox boxOf(const json& box) const {
    if (!box.is_object()) fail("a box: expected an object");
    WorldBox out;
    out.frame = frame_;
    const auto at = numbers<3>(box, "translation"), size = numbers<3>(box, "size");
    const auto q = numbers<4>(box, "rotation");
    const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
    if (!(rotation.norm() > 0.5 && rotation.norm() < 2))
      fail("rotation: expected a unit quaternion w, x, y, z");
    out.pose.translation() = Vector3(at[0], at[1], at[2]);
    out.pose.linear() = rotation.normalized().toRotationMatrix();
    out.width = size[0], out.length = size[1], out.height = size[2];
    if (!(out.width > 0 && out.length > 0 && out.height > 0))
      fail("size: expected width, length and height above 0");
    if (!box.contains("detection_name") || !box["detection_name"].is_string())
      fail("detection_name: expected a text");
    if (!box.contains("detection_score") || !box["detection_score"].is_number())
      fail("detection_score: expected a number");
    out.name = box["detection_name"].get<std::string>();
    out.score = box["detection_score"].get<double>();
    return out;
  }

  [[noreturn]] void fail(const std::string& message) const {
    throw DataError(fmt::format("{}:{}: {}", path_, line_, message));
  }

  const std::string& path_;
  std::size_t line_ = 1;
  bool in_results_ = false, has_results_ = false;
  std::int64_t frame_ = 0;
  std::vector<WorldBox> boxes_;
};

}  // namespace

bool isJsonFile(const std::string& path) {
  const std::string text = readBytes(path, kMostJsonBytes);
  const auto first = text.find_first_not_of(" \t\r\n");
  return first != std::string::npos && text[first] == '{';
}

std::vector<WorldBox> readNuscenesBoxes(const std::string& path) { return Reader(path).read(); }

}  // namespace perception
