#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/config/ParamSet.h"

namespace perception {

/// A strict INI file: every fault is collected with file and line and thrown together by finish(),
/// before any input is read. Faults: missing file, unknown section or key, duplicate, wrong type
/// (`1,5`, `12abc`, nan), out of range.
///
/// Syntax: [section], key = value, ; or # starts a comment, `include = other.ini` (path relative to
/// the file that holds it; before or inside any section). A section may be continued in a later
/// place of the same or another file, but a key occurs once per section; a file overrides those
/// that it includes, --set overrides all files.
class Config {
 public:
  /// Reads the file and its includes, from the shipped INIs where there is none of that relative
  /// path (ShippedFiles.h); syntax errors are collected for finish().
  static Config fromFile(const std::string& path);
  static Config fromText(const std::string& text, const std::string& name = "(text)");
  ~Config();
  Config(Config&&) noexcept;
  Config& operator=(Config&&) noexcept;

  /// One `section.key=value` of the command line; the last dot before '=' separates section and key
  /// unless a section exists with a longer name (sections and table keys may hold dots: the longest
  /// known section wins).
  void set(const std::string& assignment);

  /// Fills `params` from [section]; a missing section leaves the defaults unless `required`.
  template <class Params>
  Params read(const std::string& section, Params params = {}, bool required = false) {
    const auto visitor = reader(section, required);
    params.visit(*visitor);
    return params;
  }
  /// Names of the sections with that prefix, in the order of the file: "class." gives
  /// class.pedestrian, class.car ...
  std::vector<std::string> sectionsWithPrefix(const std::string& prefix) const;
  bool has(const std::string& section) const;

  /// Reports a semantic fault; file and line of the section (and of the key, when given) are added.
  void fault(const std::string& section, const std::string& key, const std::string& message);
  /// Throws ConfigError with all faults, unread sections and keys included.
  void finish() const;
  /// The effective INI: all sections read so far, as a commented INI text with every key, default
  /// or given.
  std::string effectiveText() const;
  const std::string& name() const;

 private:
  struct Impl;
  explicit Config(std::unique_ptr<Impl> impl);
  std::unique_ptr<ParamVisitor> reader(const std::string& section, bool required);
  std::unique_ptr<Impl> impl_;
};

}  // namespace perception
