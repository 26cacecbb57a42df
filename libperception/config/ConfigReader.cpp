#include "libperception/config/ConfigReader.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "libperception/config/ConfigText.h"
#include "libperception/config/IniValue.h"
#include "libperception/config/ShippedFiles.h"
#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

using Rows = std::vector<std::pair<std::string, double>>;

template <class AnyRows>
auto findRow(AnyRows& rows, const std::string& name) {
  return std::find_if(rows.begin(), rows.end(), [&](const auto& row) { return row.first == name; });
}

/// Fills a struct from a section; see makeConfigReader().
class ConfigReader final : public ParamVisitor {
 public:
  ConfigReader(const IniDocument& document, const IniSection* given, ConfigSection& section,
               std::vector<IniFault>& faults)
      : document_(document), given_(given), section_(section), faults_(faults) {}

  void expert() override { expert_ = true; }

  void real(const char* key, double& value, Bounds allowed, const char* unit,
            const char* doc) override {
    const std::string usual = isWithin(allowed, value) ? formatReal(value) : "";
    if (const IniEntry* entry = take(key)) {
      const auto read = parseReal(entry->value);
      if (read && isWithin(allowed, *read)) {
        value = *read;
      } else {
        reject(*entry, expectedNumber("a number", allowed, unit) + hint(entry->value));
      }
    }
    note(key, isWithin(allowed, value) ? formatReal(value) : "", usual,
         comment(unit, rangeText(allowed), doc));
  }

  void angle(const char* key, double& value_rad, Bounds allowed_deg, const char* doc) override {
    const std::string usual = degreesWithin(value_rad, allowed_deg);
    std::string text = usual;
    if (const IniEntry* entry = take(key)) {
      const auto read = parseReal(entry->value);
      if (read && isWithin(allowed_deg, *read)) {
        value_rad = radians(*read);
        text = formatReal(*read);
      } else {
        reject(*entry, expectedNumber("a number", allowed_deg, "deg") + hint(entry->value));
      }
    }
    note(key, text, usual, comment("deg", rangeText(allowed_deg), doc));
  }

  void integer(const char* key, int& value, Bounds allowed, const char* doc) override {
    const std::string usual = isWithin(allowed, value) ? fmt::format("{}", value) : "";
    if (const IniEntry* entry = take(key)) {
      const auto read = parseInteger(entry->value);
      if (read && *read >= std::numeric_limits<int>::min() &&
          *read <= std::numeric_limits<int>::max() &&
          isWithin(allowed, static_cast<double>(*read))) {
        value = static_cast<int>(*read);
      } else {
        reject(*entry, expectedNumber("an integer", allowed, "") + hint(entry->value));
      }
    }
    note(key, isWithin(allowed, value) ? fmt::format("{}", value) : "", usual,
         comment("", rangeText(allowed), doc));
  }

  void unsigned64(const char* key, unsigned long long& value, const char* doc) override {
    const std::string usual = fmt::format("{}", value);
    if (const IniEntry* entry = take(key)) {
      if (const auto read = parseUnsigned(entry->value)) {
        value = *read;
      } else {
        reject(*entry, "an integer in 0 .. 18446744073709551615");
      }
    }
    note(key, fmt::format("{}", value), usual, comment("", "", doc));
  }

  void boolean(const char* key, bool& value, const char* doc) override {
    const std::string usual = value ? "true" : "false";
    if (const IniEntry* entry = take(key)) {
      if (const auto read = parseBoolean(entry->value)) {
        value = *read;
      } else {
        reject(*entry, "true or false");
      }
    }
    note(key, value ? "true" : "false", usual, comment("", "true | false", doc));
  }

  void text(const char* key, std::string& value, const char* doc) override {
    const std::string usual = value;
    if (const IniEntry* entry = take(key)) value = entry->value;
    note(key, value, usual, comment("", "", doc));
  }

  void path(const char* key, std::string& value, const char* doc) override {
    const std::string usual = value;
    if (const IniEntry* entry = take(key))
      value = foundOrShipped(document_.resolved(entry->value, entry->place), entry->value);
    note(key, shippedName(value), shippedName(usual), comment("", "path", doc));
  }

  void reals(const char* key, std::vector<double>& values, int count, Bounds allowed,
             const char* unit, const char* doc) override {
    const std::string usual = realsWithin(values, count, allowed);
    const std::string kind = count < 0 ? "numbers separated by commas, each"
                                       : fmt::format("{} numbers separated by commas, each", count);
    if (const IniEntry* entry = take(key)) {
      std::vector<double> read;
      for (const auto part : splitList(entry->value)) {
        const auto number = parseReal(part);
        if (number && isWithin(allowed, *number)) read.push_back(*number);
      }
      const std::size_t parts = splitList(entry->value).size();
      if (read.size() == parts && (count < 0 || parts == static_cast<std::size_t>(count))) {
        values = read;
      } else {
        reject(*entry, expectedNumber(kind.c_str(), allowed, unit));
      }
    }
    note(key, realsWithin(values, count, allowed), usual, comment(unit, rangeText(allowed), doc));
  }

  void words(const char* key, std::vector<std::string>& values, const char* doc) override {
    const std::string usual = listText(values, sameWord);
    if (const IniEntry* entry = take(key)) {
      const auto parts = splitList(entry->value);
      // A word as ";x" would begin a comment where the list is written with spaces.
      if (!std::all_of(parts.begin(), parts.end(), survivesWriting)) {
        reject(*entry, "words separated by commas");
      } else {
        values.assign(parts.begin(), parts.end());
      }
    }
    note(key, listText(values, sameWord), usual, comment("", "words", doc));
  }

  void choice(const char* key, int& index, const std::vector<std::string>& names,
              const char* doc) override {
    const std::string usual = nameAt(names, index);
    if (const IniEntry* entry = take(key)) {
      const auto found = std::find(names.begin(), names.end(), entry->value);
      if (found != names.end()) {
        index = static_cast<int>(found - names.begin());
      } else {
        const std::string nearest = nearestWord(entry->value, names);
        reject(*entry,
               fmt::format("one of {}{}", listText(names, sameWord),
                           nearest.empty() ? "" : "; did you mean " + inQuotes(nearest) + "?"));
      }
    }
    note(key, nameAt(names, index), usual,
         comment("", fmt::format("{}", fmt::join(names, " | ")), doc));
  }

  void table(const char* prefix, std::vector<std::pair<std::string, double>>& rows, Bounds allowed,
             const char* unit, const char* doc) override {
    const auto usual = rows;
    const std::string start = prefix;
    section_.prefixes.push_back(start);
    for (const auto& entry : given_ ? given_->entries : std::vector<IniEntry>{}) {
      if (entry.key.size() <= start.size() || entry.key.compare(0, start.size(), start) != 0)
        continue;
      const auto read = parseReal(entry.value);
      if (!read || !isWithin(allowed, *read)) {
        reject(entry, expectedNumber("a number", allowed, unit) + hint(entry.value));
        continue;
      }
      const std::string name = entry.key.substr(start.size());
      const auto row = findRow(rows, name);
      if (row == rows.end()) {
        rows.emplace_back(name, *read);
      } else {
        row->second = *read;
      }
    }
    noteRows(start, rows, usual, allowed, comment(unit, rangeText(allowed), doc));
  }

  void require(bool holds, const std::string& message) override {
    // A rejected value left the default in place: a constraint on it would report a value that was
    // not given.
    if (holds || rejected_) return;
    faults_.push_back(
        {given_ ? given_->place : IniPlace{}, fmt::format("[{}]: {}", section_.name, message)});
  }

 private:
  static std::string degreesWithin(double angle_rad, Bounds allowed_deg) {
    const auto text = formatDegrees(angle_rad);
    return text && isWithin(allowed_deg, *parseReal(*text)) ? *text : "";
  }

  static std::string realsWithin(const std::vector<double>& values, int count, Bounds allowed) {
    const bool fits = (count < 0 || values.size() == static_cast<std::size_t>(count)) &&
                      std::all_of(values.begin(), values.end(),
                                  [&](double value) { return isWithin(allowed, value); });
    return fits ? listText(values, formatReal) : "";
  }

  static std::string nameAt(const std::vector<std::string>& names, int index) {
    return index >= 0 && index < static_cast<int>(names.size())
               ? names[static_cast<std::size_t>(index)]
               : "";
  }

  const IniEntry* take(const char* key) {
    section_.known.emplace_back(key);
    return given_ ? given_->find(key) : nullptr;
  }

  void reject(const IniEntry& entry, const std::string& expected) {
    rejected_ = true;
    faults_.push_back({entry.place, fmt::format("[{}] {}: found {}, expected {}", section_.name,
                                                entry.key, inQuotes(entry.value), expected)});
  }

  void note(const std::string& key, const std::string& value, const std::string& usual,
            const std::string& comment) {
    const auto noted = std::find_if(section_.keys.begin(), section_.keys.end(),
                                    [&](const ConfigKey& k) { return k.name == key; });
    if (noted == section_.keys.end()) {
      section_.keys.push_back({key, value, usual, comment, expert_, survivesWriting(value)});
    } else if (noted->value != value && !isGiven(key)) {
      addDefault(*noted, usual);
    }
  }

  bool isGiven(const std::string& key) const { return given_ && given_->find(key); }

  static void addDefault(ConfigKey& key, const std::string& usual) {
    const std::string also = " or " + (usual.empty() ? "not set" : usual);
    if (key.active) key.value.clear();
    key.active = false;
    if ((" or " + key.usual + " or ").find(also + " or ") == std::string::npos) key.usual += also;
  }

  void noteRows(const std::string& prefix, const Rows& rows, const Rows& usual, Bounds allowed,
                const std::string& comment) {
    const bool again = std::count(section_.prefixes.begin(), section_.prefixes.end(), prefix) > 1;
    if (rows.empty() && !again) note(prefix + "NAME", "", "", comment);
    const std::size_t before_all = section_.keys.size();
    for (const auto& [name, value] : rows) {
      const auto before = findRow(usual, name);
      note(prefix + name, isWithin(allowed, value) ? formatReal(value) : "",
           before == usual.end() ? "" : formatReal(before->second), comment);
    }
    if (!again) return;
    // Default rows that only one of several structs has are kept.
    for (std::size_t i = 0; i < section_.keys.size(); ++i) {
      ConfigKey& key = section_.keys[i];
      if (key.name.compare(0, prefix.size(), prefix) != 0 || isGiven(key.name)) continue;
      const bool here = findRow(rows, key.name.substr(prefix.size())) != rows.end();
      if (i >= before_all || (!here && key.active)) addDefault(key, "");
    }
  }

  const IniDocument& document_;
  const IniSection* given_;
  ConfigSection& section_;
  std::vector<IniFault>& faults_;
  bool rejected_ = false, expert_ = false;
};

}  // namespace

std::unique_ptr<ParamVisitor> makeConfigReader(const IniDocument& document, const IniSection* given,
                                               ConfigSection& section,
                                               std::vector<IniFault>& faults) {
  return std::make_unique<ConfigReader>(document, given, section, faults);
}

}  // namespace perception
