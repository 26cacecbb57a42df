#pragma once
#include "libperception/config/ParamSet.h"
#include "libperception/core/math/Angle.h"

namespace perception {

/// Parameters of the safety grid: [grid]. Values: method.md 8.4 unless a comment says otherwise.
struct GridParams {
  enum class BackEnd { kOctomap, kMrpt2d, kRolling, kRolling2d };

  bool enabled = true;  ///< free distance and stop advice in the scenes of a run with a lidar
  BackEnd back_end = BackEnd::kRolling;
  double resolution = 0.2;        ///< [m] edge of a cell
  double size = 80;               ///< [m] edge of the window around the vehicle
  double hit = 0.85;              ///< [log-odds] a scan with a return in the cell [hornung2013]
  double miss = -0.4;             ///< [log-odds] a scan with a beam through the cell [hornung2013]
  double low = -2, high = 3.5;    ///< [log-odds] bounds of a cell [hornung2013]
  double tau = 5;                 ///< [s] time constant of decay: log-odds times exp(-t/tau)
  double occupied = 1.5;          ///< [log-odds] above which a cell is occupied
  double z_min = 0.3, z_max = 3;  ///< [m] above the ground (method.md 8.1): the slab of obstacles
  double grade = 0.05;  ///< [-] widening of the slab per meter of distance: the road may deviate
                        ///< from the vehicle's plane (assumed)
  double ray_step = radians(0.5);  ///< [rad] one clearing ray per step of bearing and elevation;
                                   ///< hits are not subsampled (assumed, for 10 Hz)

  void visit(ParamVisitor& v);
};

}  // namespace perception
