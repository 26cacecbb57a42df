// Our observation classes and drivers for MRPT's stock programs: rawlog-edit -p, RawLogViewer -l,
// rawlog-grabber -p.
#include <mrpt/core/initializer.h>

#include "libperception/capture/CPacketSensor.h"
#include "libperception/capture/CScenarioSensor.h"
#include "libperception/sensors/registerClasses.h"

MRPT_INITIALIZER(registerPerceptionPlugin) {
  perception::registerPerceptionClasses();
  perception::CScenarioSensor::doRegister();
  perception::CPacketSensor::doRegister();
}
