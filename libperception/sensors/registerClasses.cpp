#include "libperception/sensors/registerClasses.h"

#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/registerAllClasses.h>
#include <mrpt/rtti/CObject.h>

#include <mutex>

#include "libperception/measurement/CObservationMeasurements.h"
#include "libperception/sensors/CObservationLidarScan.h"
#include "libperception/sensors/CObservationObjectDetections.h"
#include "libperception/sensors/CObservationRadarScan.h"

namespace perception {

void registerPerceptionClasses() {
  static std::once_flag once;
  std::call_once(once, [] {
    mrpt::obs::registerAllClasses_mrpt_obs();
    mrpt::maps::registerAllClasses_mrpt_maps();
    mrpt::rtti::registerClass(CLASS_ID(CObservationLidarScan));
    mrpt::rtti::registerClass(CLASS_ID(CObservationObjectDetections));
    mrpt::rtti::registerClass(CLASS_ID(CObservationRadarScan));
    mrpt::rtti::registerClass(CLASS_ID(CObservationMeasurements));
  });
}

}  // namespace perception
