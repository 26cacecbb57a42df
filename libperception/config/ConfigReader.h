#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/config/IniDocument.h"
#include "libperception/config/ParamSet.h"

namespace perception {

/// One key as the effective INI shows it.
struct ConfigKey {
  std::string name, value;
  std::string usual;    ///< the default in the same writing; "": none
  std::string comment;  ///< unit, range and purpose
  bool expert = false;  ///< see ParamVisitor::expert()
  bool active = true;   ///< false: the value cannot be written (nothing, NaN, outside its range):
                        ///< leave the key out
};

/// What the program knows of one section after its structs were visited.
struct ConfigSection {
  std::string name;
  std::vector<std::string> known;     ///< keys
  std::vector<std::string> prefixes;  ///< of tables
  std::vector<ConfigKey> keys;        ///< in the order of the visit
};

/// The visitor that fills a struct from `given` (null: defaults stay), collects faults and notes
/// keys in `section`. The arguments must outlive it.
std::unique_ptr<ParamVisitor> makeConfigReader(const IniDocument& document, const IniSection* given,
                                               ConfigSection& section,
                                               std::vector<IniFault>& faults);

}  // namespace perception
