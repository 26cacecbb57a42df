#pragma once
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "libperception/core/Error.h"

namespace perception {

inline std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
}

/// A value of the file that knows its place, for messages. Must not outlive its parent.
class JsonItem {
 public:
  JsonItem(const nlohmann::json& json, const std::string& file) : json_(json), file_(file) {}

  [[noreturn]] void fail(const std::string& expected) const {
    const std::string where = place();
    throw DataError(fmt::format("{}: {}: found {}, expected {}", file_,
                                where.empty() ? "outermost value" : where, shown(), expected));
  }
  bool has(const char* key) const { return json_.is_object() && json_.contains(key); }
  JsonItem at(const char* key) const {
    if (!json_.is_object()) fail("an object");
    const auto found = json_.find(key);
    if (found == json_.end()) fail(fmt::format("a member '{}'", key));
    return JsonItem(*found, this, key, 0);
  }
  /// `name`: shown in messages instead of the index.
  JsonItem at(std::size_t index, const char* name = nullptr) const {
    return JsonItem(json_[index], this, name, index);
  }
  /// Number of the members of an array.
  std::size_t size(std::size_t least, std::size_t most) const {
    if (!json_.is_array() || json_.size() < least || json_.size() > most)
      fail(least == most ? fmt::format("an array of {}", least)
                         : fmt::format("an array of {} to {}", least, most));
    return json_.size();
  }
  /// Refuses members of other names.
  template <class Names>
  void only(const Names& names) const {
    if (!json_.is_object()) fail("an object");
    for (const auto& member : json_.items())
      if (std::find(names.begin(), names.end(), member.key()) == names.end())
        fail(fmt::format("no member {}", quoted(member.key())));
  }
  double number(double low, double high) const {
    const double value = json_.is_number() ? json_.get<double>() : std::nan("");
    if (!(value >= low && value <= high))
      fail(fmt::format("a number from {:g} to {:g}", low, high));
    return value;
  }
  float real() const {
    constexpr double kMost = 3e38;  // of float
    return static_cast<float>(number(-kMost, kMost));
  }
  std::int64_t whole(std::int64_t low, std::int64_t high) const {
    const bool fits = json_.is_number_unsigned()
                          ? json_.get<std::uint64_t>() <= static_cast<std::uint64_t>(high)
                          : json_.is_number_integer();
    const std::int64_t value = fits ? json_.get<std::int64_t>() : low - 1;
    if (value < low || value > high) fail(fmt::format("a whole number from {} to {}", low, high));
    return value;
  }
  std::string text() const {
    if (!json_.is_string()) fail("a text");
    return json_.get<std::string>();
  }
  bool flag() const {
    if (!json_.is_boolean()) fail("true or false");
    return json_.get<bool>();
  }
  void mustBe(const nlohmann::json& expected) const {
    if (json_ != expected) fail(expected.dump());
  }

 private:
  JsonItem(const nlohmann::json& json, const JsonItem* parent, const char* key, std::size_t index)
      : json_(json), file_(parent->file_), parent_(parent), key_(key), index_(index) {}

  std::string place() const {
    if (!parent_) return "";
    const std::string before = parent_->place();
    if (!key_) return fmt::format("{}[{}]", before, index_);
    return before.empty() ? key_ : before + "." + key_;
  }
  std::string shown() const {
    if (json_.is_array()) return fmt::format("an array of {}", json_.size());
    if (json_.is_object()) return fmt::format("an object of {} members", json_.size());
    if (json_.is_string() && json_.get_ref<const std::string&>().size() > 60) return "a long text";
    return json_.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  }

  const nlohmann::json& json_;
  const std::string& file_;
  const JsonItem* parent_ = nullptr;
  const char* key_ = nullptr;
  std::size_t index_ = 0;
};

}  // namespace perception
