#pragma once
#include <memory>
#include <string>
#include <vector>

#include "libperception/config/IniDocument.h"
#include "libperception/config/ParamSet.h"

namespace perception {

/// One key, as written to the effective INI.
struct ConfigKey {
  std::string name, value;
  std::string usual;    ///< the default in the same format; "": none
  std::string comment;  ///< unit, range and purpose
  bool expert = false;  ///< see ParamVisitor::expert()
  bool active = true;   ///< false: the value cannot be written (empty, NaN, out of range): the key
                        ///< is commented out
};

/// The keys of one section, known after its structs were visited.
struct ConfigSection {
  std::string name;
  std::vector<std::string> known;     ///< keys
  std::vector<std::string> prefixes;  ///< of tables
  std::vector<ConfigKey> keys;        ///< in the order of the visit
};

/// The visitor that fills a struct from `given` (null: keeps the defaults), appends to `faults` and
/// records the keys in `section`. The arguments must outlive it.
std::unique_ptr<ParamVisitor> makeConfigReader(const IniDocument& document, const IniSection* given,
                                               ConfigSection& section,
                                               std::vector<IniFault>& faults);

}  // namespace perception
