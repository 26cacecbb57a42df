#include "libperception/grid/GridParams.h"

namespace perception {

void GridParams::visit(ParamVisitor& v) {
  v.choiceOf("back_end", back_end, {"octomap", "mrpt2d", "rolling", "rolling2d"},
             "octomap, rolling: cells in space; mrpt2d, rolling2d: of the ground, cheaper; "
             "rolling and rolling2d for real time");
  v.real("resolution", resolution, {0.05, 2}, "m", "edge of a cell (method.md 8.4)");
  v.real("size", size, {5, 400}, "m", "edge of the window around the vehicle (method.md 8.4)");
  v.real("hit", hit, {0.01, 5}, "log-odds", "a scan with a return in the cell (method.md 8.4)");
  v.real("miss", miss, {-5, -0.01}, "log-odds",
         "a scan with a beam through the cell (method.md 8.4)");
  v.real("low", low, {-7, -0.1}, "log-odds", "lower bound of a cell (method.md 8.4)");
  v.real("high", high, {0.1, 7}, "log-odds", "upper bound of a cell (method.md 8.4)");
  v.real("tau", tau, {0.1, 3600}, "s", "in which a cell forgets (method.md 8.4)");
  v.real("occupied", occupied, {0, 7}, "log-odds", "above which a cell blocks (method.md 8.4)");
  v.real("z_min", z_min, {-2, 5}, "m",
         "lowest height above the ground that matters (method.md 8.1)");
  v.real("z_max", z_max, {0.1, 20}, "m",
         "highest height above the ground that matters (method.md 8.1)");
  v.real("grade", grade, {0, 0.3}, "-",
         "widening of that slab per meter: the road may leave the vehicle's plane");
  v.angle("ray_step_deg", ray_step, {0.05, 5},
          "one clearing ray per step of bearing and elevation");
  v.require(occupied < high, "occupied must be below high");
  v.require(z_min < z_max, "z_min must be below z_max");
  v.require(size >= 10 * resolution, "size must be at least ten cells");
}

}  // namespace perception
