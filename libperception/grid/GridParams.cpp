#include "libperception/grid/GridParams.h"

namespace perception {

void GridParams::visit(ParamVisitor& v) {
  v.boolean("enabled", enabled,
            "free distance and stop advice in scenes.csv; pictures have the grid all the same");
  v.expert();
  v.choiceOf("back_end", back_end, {"octomap", "mrpt2d", "rolling", "rolling2d"},
             "octomap, rolling: 3D cells; mrpt2d, rolling2d: 2D cells, cheaper; "
             "rolling and rolling2d for real time");
  v.real("resolution", resolution, {0.05, 2}, "m", "edge of a cell");
  v.real("size", size, {5, 400}, "m", "edge of the window around the vehicle");
  v.real("occupied", occupied, {0, 3.4}, "log-odds", "above which a cell is occupied");
  v.require(size >= 10 * resolution, "size must be at least ten cells");
}

}  // namespace perception
