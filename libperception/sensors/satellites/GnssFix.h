#pragma once
#include <mrpt/obs/CObservationGPS.h>

#include <optional>

#include "libperception/config/ParamSet.h"
#include "libperception/core/Frames.h"
#include "libperception/core/Time.h"

namespace perception {

/// Standard deviations of a GNSS receiver whose messages do not give them: part of [ego]. Figures
/// of data sheets, assumed (method.md 1.4).
struct GnssParams {
  double sigma = 1.5;           ///< [m] of a plain fix at HDOP 1, east and north each
  double rtk_sigma = 0.03;      ///< [m] of a fixed RTK solution
  double height_factor = 2;     ///< [-] of the deviation of heights over that of east and north
  double velocity_sigma = 0.2;  ///< [m/s] of Doppler speed and course (RMC, VTG)

  void visit(ParamVisitor& v);
};

/// A position on WGS84.
struct Geodetic {
  double latitude = 0, longitude = 0;  ///< [deg] north, east
  double height = 0;                   ///< [m] above the ellipsoid
};

/// One position of a GNSS receiver, with velocity and heading where its messages have them.
struct GnssFix {
  Stamp stamp;
  Geodetic place;           ///< of the antenna
  bool has_height = true;   ///< false: RMC and GLL alone
  double sigma = 1.5;       ///< [m] east and north each
  double height_sigma = 3;  ///< [m]
  bool has_velocity = false;
  Vector2 velocity = Vector2::Zero();  ///< [m/s] east, north
  double velocity_sigma = 0.2;         ///< [m/s] each
  std::optional<double> yaw;           ///< [rad] of the vehicle, from east; of receivers with INS
  double yaw_sigma = 0.02;             ///< [rad]
  Vector3 antenna = Vector3::Zero();   ///< [m] in the vehicle frame
};

/// The best position among the messages of an observation: NMEA GGA, RMC, GLL (speed and course of
/// RMC, VTG), Novatel BESTPOS, INSPVAS (with INSCOVS), Topcon PZS (geodetic or cartesian). Empty
/// when there is none or the receiver marks it as invalid.
std::optional<GnssFix> gnssFix(const mrpt::obs::CObservationGPS& observation,
                               const GnssParams& params);

/// East, north, up [m] about a position on WGS84.
class LocalFrame {
 public:
  explicit LocalFrame(const Geodetic& origin) : origin_(origin) {}
  Vector3 fromGeodetic(const Geodetic& place) const;
  Geodetic toGeodetic(const Vector3& enu) const;
  const Geodetic& origin() const { return origin_; }

 private:
  Geodetic origin_;
};

}  // namespace perception
