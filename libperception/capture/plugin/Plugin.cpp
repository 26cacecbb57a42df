// Our observation classes, drivers and the safety grid as a metric map for MRPT's stock programs:
// rawlog-edit -p, RawLogViewer -l, rawlog-grabber -p.
#include <mrpt/core/initializer.h>

#include "libperception/capture/drivers/registerDrivers.h"
#include "libperception/grid/CSafetyGrid.h"
#include "libperception/sensors/observations/registerClasses.h"

MRPT_INITIALIZER(registerPerceptionPlugin) {
  perception::registerPerceptionClasses();
  perception::registerSafetyGrid();
  perception::registerDrivers();
}
