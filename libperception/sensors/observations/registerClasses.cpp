#include "libperception/sensors/observations/registerClasses.h"

#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/registerAllClasses.h>
#include <mrpt/rtti/CObject.h>

#include <mutex>

#include "libperception/sensors/observations/CObservationLidarScan.h"
#include "libperception/sensors/observations/CObservationObjectDetections.h"
#include "libperception/sensors/observations/CObservationRadarScan.h"

namespace perception {

void registerPerceptionClasses() {
  static std::once_flag once;
  std::call_once(once, [] {
    mrpt::obs::registerAllClasses_mrpt_obs();
    mrpt::maps::registerAllClasses_mrpt_maps();
    mrpt::rtti::registerClass(CLASS_ID(CObservationLidarScan));
    mrpt::rtti::registerClass(CLASS_ID(CObservationObjectDetections));
    mrpt::rtti::registerClass(CLASS_ID(CObservationRadarScan));
  });
}

}  // namespace perception
