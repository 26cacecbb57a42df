#include "libperception/sensors/observations/Conversions.h"

namespace perception {

namespace {

constexpr std::int64_t kNsPerTick = 100;
/// Ticks of 100 ns from 1601-01-01 to 1970-01-01 (134774 days), as in mrpt::Clock.
constexpr std::int64_t kUnixEpoch = 134774LL * 86400 * 10'000'000;
constexpr std::int64_t kEnd =
    (1LL << 32) * 10'000'000;  ///< [ticks since 1970] 2106-02-07: overflow of 32-bit seconds

}  // namespace

Pose3 toPose3(const mrpt::poses::CPose3D& pose) {
  mrpt::math::CMatrixDouble44 m;
  pose.getHomogeneousMatrix(m);
  Pose3 result = Pose3::Identity();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 4; ++j) result.matrix()(i, j) = m(i, j);
  }
  return result;
}

mrpt::poses::CPose3D toMrpt(const Pose3& pose) {
  mrpt::math::CMatrixDouble44 m;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) m(i, j) = pose.matrix()(i, j);
  }
  return mrpt::poses::CPose3D(m);
}

std::optional<Stamp> toStamp(const mrpt::system::TTimeStamp& stamp) {
  const std::int64_t since_1601 = stamp.time_since_epoch().count();
  if (since_1601 <= kUnixEpoch || since_1601 >= kUnixEpoch + kEnd) return {};
  return Stamp{(since_1601 - kUnixEpoch) * kNsPerTick};
}

mrpt::system::TTimeStamp fromStamp(Stamp stamp) {
  std::int64_t ticks = stamp.ns / kNsPerTick;
  if (stamp.ns % kNsPerTick < 0) --ticks;
  return mrpt::system::TTimeStamp(mrpt::Clock::duration(ticks + kUnixEpoch));
}

}  // namespace perception
