#pragma once
#include <string>
#include <vector>

namespace perception {

/// Closed range of allowed values, in the unit of the INI file.
struct Bounds {
  double low, high;
};

/// Visits the parameters of one INI section. The struct of a section has
///   void visit(ParamVisitor& v) { v.real("near_threshold", near_threshold, {0.05, 5}, "m", "single
///   linkage"); }
/// and its member initializers are the defaults. The same visit loads, checks, saves and documents.
class ParamVisitor {
 public:
  virtual ~ParamVisitor() = default;
  virtual void real(const char* key, double& value, Bounds allowed, const char* unit,
                    const char* doc) = 0;
  /// Degrees in the file (the key ends in _deg; bounds in degrees), radians in the struct.
  virtual void angle(const char* key_deg, double& value_rad, Bounds allowed_deg,
                     const char* doc) = 0;
  virtual void integer(const char* key, int& value, Bounds allowed, const char* doc) = 0;
  /// Any 64-bit unsigned number (seeds).
  virtual void unsigned64(const char* key, unsigned long long& value, const char* doc) = 0;
  virtual void boolean(const char* key, bool& value, const char* doc) = 0;
  virtual void text(const char* key, std::string& value, const char* doc) = 0;
  /// A path; a relative one starts at the folder of the INI file that holds the line.
  virtual void path(const char* key, std::string& value, const char* doc) = 0;
  /// A comma-separated list of reals; `count` < 0 allows any number.
  virtual void reals(const char* key, std::vector<double>& values, int count, Bounds allowed,
                     const char* unit, const char* doc) = 0;
  /// A comma-separated list of words.
  virtual void words(const char* key, std::vector<std::string>& values, const char* doc) = 0;
  /// One of `names`; `index` is its index.
  virtual void choice(const char* key, int& index, const std::vector<std::string>& names,
                      const char* doc) = 0;
  /// Every key `prefix`NAME of the section, NAME free: a table of reals by name (label.car_sized =
  /// .94).
  virtual void table(const char* prefix, std::vector<std::pair<std::string, double>>& rows,
                     Bounds allowed, const char* unit, const char* doc) = 0;
  /// The keys visited from here on are for experts: --print-config shows them last. A key that no
  /// shipped INI sets is either an expert's or no key.
  virtual void expert() {}
  /// A constraint on several keys: when `holds` is false while loading, `message` is reported with
  /// the line of the section.
  virtual void require(bool holds, const std::string& message) = 0;

  template <class Enum>
  void choiceOf(const char* key, Enum& value, const std::vector<std::string>& names,
                const char* doc) {
    int index = static_cast<int>(value);
    choice(key, index, names, doc);
    value = static_cast<Enum>(index);
  }
};

}  // namespace perception
