#include "libperception/config/IniDocument.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "libperception/config/IniFile.h"
#include "libperception/config/IniValue.h"
#include "libperception/config/ShippedFiles.h"

namespace perception {
namespace {

const std::string kNoSection = "[";  // not a valid section name

}  // namespace

const IniEntry* IniSection::find(const std::string& key) const {
  const auto found = std::find_if(entries.begin(), entries.end(),
                                  [&](const IniEntry& entry) { return entry.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

const IniSection* IniDocument::find(const std::string& section) const {
  const auto found = std::find_if(sections_.begin(), sections_.end(),
                                  [&](const IniSection& s) { return s.name == section; });
  return found == sections_.end() ? nullptr : &*found;
}

std::string IniDocument::where(const IniPlace& place) const {
  if (place.source < 0) return name();
  const std::string& source = sources_[static_cast<std::size_t>(place.source)].name;
  return place.line > 0 ? fmt::format("{}:{}", source, place.line) : source;
}

std::string IniDocument::resolved(const std::string& path, const IniPlace& place) const {
  return joined(sources_[static_cast<std::size_t>(place.source)].folder, path);
}

int IniDocument::addSource(const std::string& name) {
  sources_.push_back({name, "", "", {}});
  return static_cast<int>(sources_.size()) - 1;
}

void IniDocument::readFile(const std::string& given) {
  const std::string path = foundOrShipped(given, given);
  const int source = addSource(path);
  std::string content;
  const std::string trouble = readWhole(path, content);
  if (trouble.empty()) {
    sources_.back().folder = folderOf(path);
    sources_.back().identity = identityOf(path);
    readLines(source, content);
  } else {
    complete_ = false;
    addFault({source, 0}, trouble);
  }
  merge();
}

void IniDocument::readText(const std::string& text, const std::string& name) {
  readLines(addSource(name), text);
  merge();
}

void IniDocument::readLines(int source, std::string_view text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.substr(0, 2) == "\xFF\xFE" || text.substr(0, 2) == "\xFE\xFF") {
    addFault({source, 1}, "found UTF-16, expected UTF-8");
    complete_ = false;
    return;
  }
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    text.remove_prefix(kByteOrderMark.size());
  }
  open_.push_back(source);
  std::string section;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = text.find('\n');
    readLine(source, number, text.substr(0, end), section);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
  }
  open_.pop_back();
}

void IniDocument::readLine(int source, int number, std::string_view line, std::string& section) {
  const IniPlace place{source, number};
  line = trimmed(line.substr(0, commentStart(line)));
  if (line.empty()) return;
  if (line.front() == '[') return readTitle(place, line, section);
  const std::size_t equals = line.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    return addFault(place, fmt::format("found {}, expected [section], key = value or a comment",
                                       inQuotes(line)));
  }
  const std::string key(trimmed(line.substr(0, equals)));
  const std::string value(trimmed(line.substr(equals + 1)));
  if (key == "include" || (section.empty() && key == "relative_paths")) {
    return readDirective(place, key, value);
  }
  if (section.empty()) {
    return addFault(place, fmt::format("{}: key outside of any section, expected a [section] first",
                                       inQuotes(key)));
  }
  if (section == kNoSection) return;  // its title was reported already
  if (value.empty()) {
    return addFault(place,
                    fmt::format("[{}] {}: found no value, expected one after '='", section, key));
  }
  if (!survivesWriting(value) || !survivesWriting(key)) {
    return addFault(
        place, fmt::format("[{}] {}: found {}, expected a line without control characters", section,
                           escaped(key), inQuotes(value)));
  }
  lines_.push_back({section, key, value, place});
}

void IniDocument::readTitle(const IniPlace& place, std::string_view line, std::string& section) {
  const std::string_view name = trimmed(line.substr(1, line.size() - 2));
  if (line.back() != ']' || name.empty() || name.find_first_of("[]=") != std::string_view::npos ||
      !survivesWriting(name)) {
    section = kNoSection;
    addFault(place, fmt::format("found {}, expected a title as [section]", inQuotes(line)));
    return;
  }
  section = std::string(name);
  lines_.push_back({section, "", "", place});
}

void IniDocument::readDirective(const IniPlace& place, const std::string& key,
                                const std::string& value) {
  if (key == "include") return include(place, value);
  auto& source = sources_[static_cast<std::size_t>(place.source)];
  if (value == "working-folder") {
    source.folder.clear();
  } else if (value != "this-file") {
    addFault(place, fmt::format("relative_paths: found {}, expected this-file or working-folder",
                                inQuotes(value)));
  }
}

void IniDocument::include(const IniPlace& place, const std::string& value) {
  if (!survivesWriting(value)) {
    return addFault(place, fmt::format("include: found {}, expected a file", inQuotes(value)));
  }
  // Relative to the including file's folder, whatever its relative_paths says.
  const auto& includer = sources_[static_cast<std::size_t>(place.source)];
  const std::string folder = includer.identity.empty() ? "" : folderOf(includer.name);
  const std::string path = foundOrShipped(joined(folder, value), value);
  const std::string identity = identityOf(path);
  const auto known = std::find_if(sources_.begin(), sources_.end(),
                                  [&](const Source& s) { return s.identity == identity; });
  if (known != sources_.end()) {
    const int other = static_cast<int>(known - sources_.begin());
    const auto begin = std::find(open_.begin(), open_.end(), other);
    if (begin == open_.end()) {  // read before, through another file
      sources_[static_cast<std::size_t>(place.source)].includes.push_back(other);
      return;
    }
    std::string chain;
    for (auto i = begin; i != open_.end(); ++i) {
      chain += sources_[static_cast<std::size_t>(*i)].name + " includes ";
    }
    return addFault(place, fmt::format("include: files include each other in a circle: {}{}", chain,
                                       known->name));
  }
  std::string content;
  const std::string trouble = readWhole(path, content);
  if (!trouble.empty()) {
    complete_ = false;
    return addFault(place, fmt::format("include: {} {}", inQuotes(path), trouble));
  }
  const int source = addSource(path);
  sources_.back().folder = folderOf(path);
  sources_.back().identity = identity;
  sources_[static_cast<std::size_t>(place.source)].includes.push_back(source);
  readLines(source, content);
}

bool IniDocument::includes(int source, int other) const {
  const auto& below = sources_[static_cast<std::size_t>(source)].includes;
  return std::any_of(below.begin(), below.end(),
                     [&](int next) { return next == other || includes(next, other); });
}

IniSection& IniDocument::section(const std::string& name, const IniPlace& place) {
  const auto found = std::find_if(sections_.begin(), sections_.end(),
                                  [&](const IniSection& s) { return s.name == name; });
  if (found != sections_.end()) return *found;
  sections_.push_back({name, place, true, {}});
  return sections_.back();
}

// Selects the effective line of each key, once all files are read.
void IniDocument::merge() {
  std::map<std::pair<std::string, std::string>, std::vector<const Line*>> groups;
  for (const auto& line : lines_) groups[{line.section, line.key}].push_back(&line);
  for (const auto& line : lines_) {
    section(line.section, line.place);
    const auto& group = groups[{line.section, line.key}];
    if (!line.key.empty() && group.front() == &line) mergeKey(group);
  }
}

void IniDocument::mergeKey(const std::vector<const Line*>& lines) {
  const Line* winner = nullptr;
  for (const Line* line : lines) {
    const bool overridden = std::any_of(lines.begin(), lines.end(), [&](const Line* other) {
      return includes(other->place.source, line->place.source);
    });
    if (overridden) continue;
    if (!winner) {
      winner = line;
      section(line->section, line->place).entries.push_back({line->key, line->value, line->place});
    } else {
      addFault(line->place, fmt::format("[{}] {}: duplicate, first in {}", line->section, line->key,
                                        where(winner->place)));
    }
  }
}

void IniDocument::set(const std::string& assignment) {
  const int source = addSource("--set " + escaped(assignment));
  const IniPlace place{source, 0};
  const std::size_t equals = assignment.find('=');
  const std::string name(trimmed(std::string_view(assignment).substr(0, equals)));
  std::size_t dot = name.rfind('.');
  if (equals == std::string::npos || dot == std::string::npos || dot == 0 ||
      dot + 1 == name.size()) {
    return addFault(place, "expected section.key=value");
  }
  const std::string value(trimmed(std::string_view(assignment).substr(equals + 1)));
  if (!survivesWriting(value) || !survivesWriting(name)) {
    return addFault(place, fmt::format("found {}, expected a value of one line without a comment",
                                       inQuotes(value)));
  }
  // Sections and keys of tables may hold dots: the longest section that a file has wins.
  std::size_t longest = 0;
  for (const auto& s : sections_) {
    const bool begins = name.size() > s.name.size() + 1 && name[s.name.size()] == '.' &&
                        name.compare(0, s.name.size(), s.name) == 0;
    if (begins && s.in_file) longest = std::max(longest, s.name.size());
  }
  if (longest > 0) dot = longest;
  const std::string key = name.substr(dot + 1);
  const bool is_new = !find(name.substr(0, dot));
  IniSection& target = section(name.substr(0, dot), place);
  if (is_new) target.in_file = false;
  const auto entry = std::find_if(target.entries.begin(), target.entries.end(),
                                  [&](const IniEntry& e) { return e.key == key; });
  if (entry == target.entries.end()) {
    target.entries.push_back({key, value, place});
  } else {
    *entry = {key, value, place};
  }
}

void IniDocument::claim(const std::string& name) {
  std::vector<IniEntry> moved;
  for (auto& s : sections_) {
    if (name.size() <= s.name.size() + 1 || name.compare(0, s.name.size(), s.name) != 0 ||
        name[s.name.size()] != '.') {
      continue;
    }
    const std::string prefix = name.substr(s.name.size() + 1) + '.';
    const auto begin =
        std::stable_partition(s.entries.begin(), s.entries.end(), [&](const IniEntry& e) {
          const bool by_option = e.place.source >= 0 && e.place.line == 0;
          return !by_option || e.key.size() <= prefix.size() ||
                 e.key.compare(0, prefix.size(), prefix) != 0;
        });
    for (auto e = begin; e != s.entries.end(); ++e) {
      moved.push_back({e->key.substr(prefix.size()), e->value, e->place});
    }
    s.entries.erase(begin, s.entries.end());
  }
  for (const auto& e : moved) {
    const bool is_new = !find(name);
    IniSection& target = section(name, e.place);
    if (is_new) target.in_file = false;
    const auto same = std::find_if(target.entries.begin(), target.entries.end(),
                                   [&](const IniEntry& t) { return t.key == e.key; });
    if (same == target.entries.end()) {
      target.entries.push_back(e);
    } else {
      *same = e;
    }
  }
}

}  // namespace perception
