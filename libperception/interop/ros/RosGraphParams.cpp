#include "libperception/interop/ros/RosGraphParams.h"

namespace perception {

void RosGraphParams::visit(ParamVisitor& v) {
  v.text("network", network,
         "INTERFACE or INTERFACE:DOMAIN, as lo:0: where the graph is; lo stays on this computer");
  v.real("patience", patience, {0, 60}, "s",
         "sensor data waits for as long for the place of its frame on the vehicle");
  v.text("world_frame", world_frame, "frame of what is sent");
  v.boolean("send_transforms", send_transforms,
            "send the vehicle's place in world_frame as a transform; no where the graph has it");
}

}  // namespace perception
