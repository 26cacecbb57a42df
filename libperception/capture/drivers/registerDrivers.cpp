#include "libperception/capture/drivers/registerDrivers.h"

#include "libperception/capture/drivers/CDdsSensor.h"
#include "libperception/capture/drivers/CPacketSensor.h"
#include "libperception/capture/drivers/CRawlogSensor.h"
#include "libperception/capture/drivers/CScenarioSensor.h"
#include "libperception/capture/ros/CRosSensor.h"

namespace perception {

void registerDrivers() {
  CScenarioSensor::doRegister();
  CPacketSensor::doRegister();
  CRawlogSensor::doRegister();
  CDdsSensor::doRegister();
  CRosSensor::doRegister();
}

}  // namespace perception
