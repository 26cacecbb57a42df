#pragma once
#include <string>

#include "libperception/config/ParamSet.h"

namespace perception {

/// [ros]: a running system in place of a recording, and what is sent into it. An import leaves it
/// alone.
struct RosGraphParams {
  std::string network = "lo";       ///< INTERFACE or INTERFACE:DOMAIN
  double patience = 2;              ///< [s] assumed: wait for a frame's place
  std::string world_frame = "map";  ///< of what is sent
  bool send_transforms = false;     ///< the vehicle's place in it

  void visit(ParamVisitor& v);
};

}  // namespace perception
