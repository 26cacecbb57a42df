#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace perception {

/// A position in a configuration: a line of a file or an option of the command line.
struct IniPlace {
  int source = -1;  ///< index of the file or option; -1: nowhere
  int line = 0;     ///< 1 = first; 0: the file or option as a whole
};

/// One key of a section with its effective value.
struct IniEntry {
  std::string key, value;
  IniPlace place;
};

/// All keys of one title, from all files and options, in the order of their first appearance.
struct IniSection {
  std::string name;
  IniPlace place;        ///< of its first title
  bool in_file = false;  ///< false: created by --set alone
  std::vector<IniEntry> entries;

  const IniEntry* find(const std::string& key) const;
};

/// One fault found.
struct IniFault {
  IniPlace place;
  std::string text;
};

/// The lines of an INI file, of its includes and of --set options, as sections of keys and values
/// without interpretation. Syntax: see Config.h. Never throws on bad content: faults are collected.
class IniDocument {
 public:
  /// Call one of readFile and readText, once.
  void readFile(const std::string& given);
  void readText(const std::string& text, const std::string& name);
  /// Applies `section.key=value` after reading; a later one overrides.
  void set(const std::string& assignment);

  /// Declares a section that the program knows: a --set that was read as a dotted key of a shorter
  /// section name ([sensor.A] class.car.detection) moves to it.
  void claim(const std::string& section);

  const std::vector<IniSection>& sections() const { return sections_; }
  const IniSection* find(const std::string& section) const;
  const std::vector<IniFault>& faults() const { return faults_; }
  /// False when a file could not be read: sections and keys that seem to be missing may be in it.
  bool complete() const { return complete_; }
  const std::string& name() const { return sources_.front().name; }  ///< the main file's, as given

  /// "ini/site.ini:12" or "--set run.seed=x".
  std::string where(const IniPlace& place) const;
  /// A relative path given at `place`, made relative to the working folder.
  std::string resolved(const std::string& path, const IniPlace& place) const;

 private:
  /// Origin of lines: a file, a text or an option.
  struct Source {
    std::string name;           ///< path as given, or the option
    std::string folder;         ///< base of the relative paths in this source; "": working folder
    std::string identity;       ///< canonical path; "": not a file
    std::vector<int> includes;  ///< sources
  };
  /// A title (without key) or a key with its value, as read.
  struct Line {
    std::string section, key, value;
    IniPlace place;
  };
  int addSource(const std::string& name);
  void readLines(int source, std::string_view text);
  void readLine(int source, int number, std::string_view line, std::string& section);
  void readTitle(const IniPlace& place, std::string_view line, std::string& section);
  void readDirective(const IniPlace& place, const std::string& key, const std::string& value);
  void include(const IniPlace& place, const std::string& value);
  bool includes(int source, int other) const;
  void merge();
  void mergeKey(const std::vector<const Line*>& lines);
  IniSection& section(const std::string& name, const IniPlace& place);
  void addFault(const IniPlace& place, std::string text) {
    faults_.push_back({place, std::move(text)});
  }

  std::vector<Source> sources_;
  std::vector<int> open_;  ///< sources being read, outermost first
  std::vector<Line> lines_;
  std::vector<IniSection> sections_;
  std::vector<IniFault> faults_;
  bool complete_ = true;
};

}  // namespace perception
