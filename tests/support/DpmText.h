#pragma once
#include <fmt/format.h>

#include <string>

#include "libperception/detectors/HogFeatures.h"
#include "libperception/detectors/dpm/DpmModel.h"

namespace perception::test {

inline void writeWeights(const DpmFilter& filter, std::string& out) {
  const auto row = static_cast<std::size_t>(filter.width * kHogFeatures);
  for (std::size_t i = 0; i < filter.weights.size(); ++i)
    out += fmt::format("{}{}", filter.weights[i], (i + 1) % row == 0 ? '\n' : ' ');
}

/// The plain-text form, as parseDpmModel() reads it.
inline std::string dpmModelText(const DpmModel& model) {
  std::string out =
      fmt::format("class {}\ncomponents {}\nsbin {} interval 10 thresh {}\n", model.class_name,
                  model.components.size(), model.cell, model.threshold);
  for (std::size_t k = 0; k < model.components.size(); ++k) {
    const DpmComponent& c = model.components[k];
    out += fmt::format("component {} alpha_rad {} offset {}", k, c.heading, c.offset);
    if (c.octaves[0] != 0 || c.octaves[1] != 0 || c.octaves[2] != 0)
      out += fmt::format(" octaves {} {} {}", c.octaves[0], c.octaves[1], c.octaves[2]);
    out += fmt::format(" detwindow_hw {} {} parts {}\n", c.height, c.width, c.parts.size());
    out +=
        fmt::format("root anchor_xyl 0 0 0 size_hw {} {} dims 32\n", c.root.height, c.root.width);
    writeWeights(c.root, out);
    for (std::size_t p = 0; p < c.parts.size(); ++p) {
      const DpmPart& part = c.parts[p];
      out += fmt::format("part {} anchor_xyl {} {} 1 size_hw {} {} dims 32 def {} {} {} {}\n",
                         p + 1, part.anchor_x, part.anchor_y, part.filter.height, part.filter.width,
                         part.deformation[0], part.deformation[1], part.deformation[2],
                         part.deformation[3]);
      writeWeights(part.filter, out);
    }
  }
  return out;
}

}  // namespace perception::test
