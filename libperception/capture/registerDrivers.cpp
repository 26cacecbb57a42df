#include "libperception/capture/registerDrivers.h"

#include "libperception/capture/CDdsSensor.h"
#include "libperception/capture/CPacketSensor.h"
#include "libperception/capture/CRawlogSensor.h"
#include "libperception/capture/CRosSensor.h"
#include "libperception/capture/CScenarioSensor.h"

namespace perception {

void registerDrivers() {
  CScenarioSensor::doRegister();
  CPacketSensor::doRegister();
  CRawlogSensor::doRegister();
  CDdsSensor::doRegister();
  CRosSensor::doRegister();
}

}  // namespace perception
