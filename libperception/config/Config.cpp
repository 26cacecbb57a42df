#include "libperception/config/Config.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <limits>
#include <set>
#include <utility>

#include "libperception/config/ConfigReader.h"
#include "libperception/config/IniDocument.h"
#include "libperception/config/IniValue.h"
#include "libperception/core/Error.h"

namespace perception {
namespace {

constexpr std::size_t kMostFaults = 50;  // reported; a file that is no INI file can have thousands
constexpr std::size_t kCommentColumn = 40;

bool contains(const std::vector<std::string>& words, const std::string& word) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

std::string joinedWords(const std::vector<std::string>& words) {
  return fmt::format("{}", fmt::join(words, ", "));
}

void appendKey(const ConfigKey& key, std::string& text) {
  std::string line = fmt::format("{} = {}", key.name, key.value);
  if (!key.active) {
    line = key.value.empty()
               ? fmt::format("; {} is not set", key.name)
               : fmt::format("; {} cannot be written: {}", key.name, escaped(key.value));
  }
  if (line.size() < kCommentColumn) line.resize(kCommentColumn, ' ');
  text += line + "  ; " + key.comment;
  if (key.usual != key.value) {
    text += "; default " + (key.usual.empty() ? std::string("not set") : key.usual);
  }
  text += '\n';
}

// Appends the section's keys, expert or not, under its title; nothing where there are none.
void appendSection(const ConfigSection& section, bool expert, std::string& text) {
  const auto chosen = [&](const ConfigKey& key) { return key.expert == expert; };
  const bool any = std::any_of(section.keys.begin(), section.keys.end(), chosen);
  if (!any && (expert || !section.keys.empty())) return;
  text += fmt::format("\n[{}]\n", section.name);
  for (const auto& key : section.keys) {
    if (chosen(key)) appendKey(key, text);
  }
}

}  // namespace

struct Config::Impl {
  IniDocument document;
  std::deque<ConfigSection> read;  // in the order of their first reading
  mutable std::vector<std::string>
      known_titles;                  // section names that the program knows, read or not
  std::vector<IniFault> faults;      // of values and semantics
  std::vector<std::string> missing;  // required sections that are missing

  ConfigSection& readSection(const std::string& name);
  const ConfigSection* findRead(const std::string& name) const;
  void addUnknown(const IniSection& section, std::vector<IniFault>& all) const;
  std::string unknownSection(const std::string& name) const;
  std::string unknownKey(const ConfigSection& section, const std::string& key) const;
};

ConfigSection& Config::Impl::readSection(const std::string& name) {
  for (auto& section : read) {
    if (section.name == name) return section;
  }
  read.push_back({name, {}, {}, {}});
  return read.back();
}

const ConfigSection* Config::Impl::findRead(const std::string& name) const {
  const auto found = std::find_if(read.begin(), read.end(),
                                  [&](const ConfigSection& s) { return s.name == name; });
  return found == read.end() ? nullptr : &*found;
}

std::string Config::Impl::unknownSection(const std::string& name) const {
  std::vector<std::string> candidates = known_titles;
  for (const auto& section : read) candidates.push_back(section.name);
  const std::string nearest = nearestWord(name, candidates);
  return nearest.empty() || nearest == name
             ? fmt::format("[{}]: unknown section: nothing reads it", name)
             : fmt::format("[{}]: unknown section, did you mean [{}]?", name, nearest);
}

std::string Config::Impl::unknownKey(const ConfigSection& section, const std::string& key) const {
  constexpr std::size_t kMostListed = 12;
  std::string start = fmt::format("[{}] {}: unknown key", section.name, key);
  const std::string nearest = nearestWord(key, section.known);
  if (!nearest.empty()) return fmt::format("{}, did you mean {}?", start, inQuotes(nearest));
  for (const auto& other : read) {
    if (contains(other.known, key))
      return fmt::format("{} here, it belongs to [{}]", start, other.name);
  }
  std::vector<std::string> known = section.known;
  for (const auto& prefix : section.prefixes) known.push_back(prefix + "NAME");
  if (known.size() > kMostListed) return start;
  return fmt::format("{}, expected one of {}", start, joinedWords(known));
}

void Config::Impl::addUnknown(const IniSection& section, std::vector<IniFault>& all) const {
  const ConfigSection* known = findRead(section.name);
  if (!known) {
    // Because of an include that could not be read, this section may not have been read.
    if (document.complete()) all.push_back({section.place, unknownSection(section.name)});
    return;
  }
  for (const auto& entry : section.entries) {
    const bool in_table =
        std::any_of(known->prefixes.begin(), known->prefixes.end(), [&](const std::string& prefix) {
          return entry.key.size() > prefix.size() &&
                 entry.key.compare(0, prefix.size(), prefix) == 0;
        });
    if (!in_table && !contains(known->known, entry.key)) {
      all.push_back({entry.place, unknownKey(*known, entry.key)});
    }
  }
}

Config::Config(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Config::~Config() = default;
Config::Config(Config&&) noexcept = default;
Config& Config::operator=(Config&&) noexcept = default;

Config Config::fromFile(const std::string& path) {
  auto impl = std::make_unique<Impl>();
  impl->document.readFile(path);
  return Config(std::move(impl));
}

Config Config::fromText(const std::string& text, const std::string& name) {
  auto impl = std::make_unique<Impl>();
  impl->document.readText(text, name);
  return Config(std::move(impl));
}

void Config::set(const std::string& assignment) { impl_->document.set(assignment); }

const std::string& Config::name() const { return impl_->document.name(); }

bool Config::has(const std::string& section) const {
  impl_->known_titles.push_back(section);
  impl_->document.claim(section);
  return impl_->document.find(section) != nullptr;
}

std::vector<std::string> Config::sectionsWithPrefix(const std::string& prefix) const {
  std::vector<std::string> names;
  for (const auto& section : impl_->document.sections()) {
    // --set changes existing sections; a mistyped section name must not create a class or sensor.
    if (section.in_file && section.name.compare(0, prefix.size(), prefix) == 0) {
      names.push_back(section.name);
    }
  }
  return names;
}

void Config::fault(const std::string& section, const std::string& key, const std::string& message) {
  const IniSection* found = impl_->document.find(section);
  const IniEntry* entry = found ? found->find(key) : nullptr;
  const IniPlace place = entry ? entry->place : found ? found->place : IniPlace{};
  std::string text = section.empty() ? "" : fmt::format("[{}]", section);
  if (!key.empty()) text += (text.empty() ? "" : " ") + key;
  impl_->faults.push_back({place, text.empty() ? message : text + ": " + message});
}

std::unique_ptr<ParamVisitor> Config::reader(const std::string& section, bool required) {
  impl_->document.claim(section);
  const IniSection* found = impl_->document.find(section);
  if (required && !found && !contains(impl_->missing, section)) {
    impl_->missing.push_back(section);
    impl_->faults.push_back({{}, fmt::format("[{}]: section is missing", section)});
  }
  return makeConfigReader(impl_->document, found, impl_->readSection(section), impl_->faults);
}

void Config::finish() const {
  const IniDocument& document = impl_->document;
  std::vector<IniFault> all = document.faults();
  for (const auto& fault : impl_->faults) {
    // What seems to be missing may be in a file that could not be read: then only that fault is
    // reported.
    if (fault.place.source >= 0 || document.complete()) all.push_back(fault);
  }
  for (const auto& section : document.sections()) impl_->addUnknown(section, all);
  if (all.empty()) return;
  std::stable_sort(all.begin(), all.end(), [](const IniFault& a, const IniFault& b) {
    return std::make_pair(a.place.source, a.place.line) <
           std::make_pair(b.place.source, b.place.line);
  });
  std::vector<std::string> lines;
  for (const auto& fault : all) {
    const std::string line = document.where(fault.place) + ": " + fault.text;
    if (!contains(lines, line)) lines.push_back(line);  // a section may be read twice
    if (lines.size() > kMostFaults) {
      lines.back() =
          fmt::format("{}: and more faults after the first {}", document.name(), kMostFaults);
      break;
    }
  }
  throw ConfigError(fmt::format("{}", fmt::join(lines, "\n")));
}

std::string Config::effectiveText() const {
  std::string text =
      "; Effective configuration: every section that was read, includes and --set folded in.\n"
      "; Relative paths start at the folder in which the program was started, or at that of the\n"
      "; files that come with it.\n"
      "relative_paths = working-folder\n";
  for (const auto& section : impl_->read) appendSection(section, false, text);
  std::string expert;
  for (const auto& section : impl_->read) appendSection(section, true, expert);
  if (!expert.empty()) text += "\n; expert: keys that a site rarely needs\n" + expert;
  return text;
}

}  // namespace perception
