#include "libperception/sensors/ego/CEgoFilter.h"

#include <cmath>

// MRPT instantiates only some matrix sizes in its library; those used to verify Jacobians of eleven
// components (KF_options.debug_verify_analytic_jacobians) are missing.
namespace mrpt::math {
using Matrix11 = CMatrixFixed<double, perception::kAccelBiasY, perception::kAccelBiasY>;

template <>
std::string MatrixVectorBase<double, Matrix11>::asString() const {
  return "(11 x 11)";
}
template <>
double MatrixVectorBase<double, Matrix11>::sum_abs() const {
  return mvbDerived().asEigen().cwiseAbs().sum();
}
template <>
Matrix11 MatrixVectorBase<double, Matrix11>::impl_op_subs(const Matrix11& other) const {
  Matrix11 difference;
  difference.asEigen() = mvbDerived().asEigen() - other.asEigen();
  return difference;
}
}  // namespace mrpt::math

namespace perception {

namespace {

constexpr int kVehicle = kAccelBiasY;  // components of MRPT's "vehicle"

/// Rates of yaw, pitch and roll [rad/s] from the rates about the vehicle's axes.
Vector3 angleRates(const EgoVector& x, const EgoInput& input) {
  Vector3 w = input.rates;
  if (input.gyro) w -= x.segment<3>(kEgoGyroX);
  const double sr = std::sin(x[kEgoRoll]), cr = std::cos(x[kEgoRoll]);
  const double cp = std::cos(x[kEgoPitch]), tp = std::tan(x[kEgoPitch]);
  const double turning = sr * w.y() + cr * w.z();
  return {turning / cp, cr * w.y() - sr * w.z(), w.x() + tp * turning};
}

/// Factor of pitch and roll in a step.
double levelShare(const EgoInput& input) {
  return input.level_time > 0 ? std::exp(-input.dt / input.level_time) : 1;
}

}  // namespace

// The rear axle moves along its heading; a step uses the heading at its middle.
EgoVector CEgoFilter::moved(const EgoVector& x, const EgoInput& input) {
  const double dt = input.dt, level = levelShare(input);
  const Vector3 turn = dt * angleRates(x, input);
  const double yaw = x[kEgoYaw] + turn[0] / 2, pitch = x[kEgoPitch] + turn[1] / 2;
  double acceleration = input.force;
  if (input.accelerometer) acceleration += kGravity * std::sin(x[kEgoPitch]) - x[kEgoAccel];
  const double way = dt * (x[kEgoSpeed] + dt * acceleration / 2);
  EgoVector y = x;
  y[kEgoX] += way * std::cos(yaw) * std::cos(pitch);
  y[kEgoY] += way * std::sin(yaw) * std::cos(pitch);
  y[kEgoZ] -= way * std::sin(pitch);
  y[kEgoYaw] += turn[0];
  y[kEgoPitch] = level * (y[kEgoPitch] + turn[1]);
  y[kEgoRoll] = level * (y[kEgoRoll] + turn[2]);
  y[kEgoSpeed] += dt * acceleration;
  return y;
}

EgoMatrix CEgoFilter::jacobian(const EgoVector& x, const EgoInput& input) {
  const double dt = input.dt, level = levelShare(input);
  Vector3 w = input.rates;
  if (input.gyro) w -= x.segment<3>(kEgoGyroX);
  const double sr = std::sin(x[kEgoRoll]), cr = std::cos(x[kEgoRoll]);
  const double sp = std::sin(x[kEgoPitch]), cp = std::cos(x[kEgoPitch]), tp = sp / cp;
  const double turning = sr * w.y() + cr * w.z(), tilting = cr * w.y() - sr * w.z();
  // Jacobian of the rates of yaw, pitch and roll.
  Eigen::Matrix<double, 3, kEgoAxes> rate = Eigen::Matrix<double, 3, kEgoAxes>::Zero();
  rate(0, kEgoPitch) = turning * tp / cp;
  rate(0, kEgoRoll) = tilting / cp;
  rate(1, kEgoRoll) = -turning;
  rate(2, kEgoPitch) = turning / (cp * cp);
  rate(2, kEgoRoll) = tp * tilting;
  if (input.gyro) {
    rate(0, kEgoGyroY) = -sr / cp, rate(0, kEgoGyroZ) = -cr / cp;
    rate(1, kEgoGyroY) = -cr, rate(1, kEgoGyroZ) = sr;
    rate(2, kEgoGyroX) = -1, rate(2, kEgoGyroY) = -tp * sr, rate(2, kEgoGyroZ) = -tp * cr;
  }
  rate *= dt;
  Eigen::Matrix<double, 1, kEgoAxes> speed = Eigen::Matrix<double, 1, kEgoAxes>::Zero();
  double acceleration = input.force;
  if (input.accelerometer) {
    acceleration += kGravity * sp - x[kEgoAccel];
    speed(kEgoPitch) = dt * kGravity * cp;
    speed(kEgoAccel) = -dt;
  }
  Eigen::Matrix<double, 1, kEgoAxes> way = dt / 2 * speed;
  way(kEgoSpeed) = dt;
  Eigen::Matrix<double, 1, kEgoAxes> yaw = rate.row(0) / 2, pitch = rate.row(1) / 2;
  yaw(kEgoYaw) += 1, pitch(kEgoPitch) += 1;
  const double length = dt * (x[kEgoSpeed] + dt * acceleration / 2);
  const double turned = x[kEgoYaw] + dt * turning / cp / 2;
  const double tilted = x[kEgoPitch] + dt * tilting / 2;
  const double c = std::cos(turned), s = std::sin(turned);
  const double ct = std::cos(tilted), st = std::sin(tilted);
  EgoMatrix F = EgoMatrix::Identity();
  F.row(kEgoX) += c * ct * way - length * s * ct * yaw - length * c * st * pitch;
  F.row(kEgoY) += s * ct * way + length * c * ct * yaw - length * s * st * pitch;
  F.row(kEgoZ) += -st * way - length * ct * pitch;
  F.row(kEgoYaw) += rate.row(0);
  F.row(kEgoPitch) = level * (F.row(kEgoPitch) + rate.row(1));
  F.row(kEgoRoll) = level * (F.row(kEgoRoll) + rate.row(2));
  F.row(kEgoSpeed) += speed;
  return F;
}

CEgoFilter::CEgoFilter() {
  KF_options.method = mrpt::bayes::kfEKFNaive;
  setMinLoggingLevel(mrpt::system::LVL_ERROR);
  m_xkk.resize(kEgoAxes);
  m_pkk.setSize(kEgoAxes, kEgoAxes);
}

void CEgoFilter::run(EgoEstimate& estimate) {
  m_xkk.asEigen() = estimate.x;
  m_pkk.asEigen() = estimate.P;
  runOneKalmanIteration();
  estimate.x = m_xkk.asEigen();
  estimate.P = m_pkk.asEigen();
}

void CEgoFilter::predict(EgoEstimate& estimate, const EgoInput& input) {
  if (!(input.dt > 0)) return;
  input_ = input;
  observation_ = {};
  moving_ = true;
  run(estimate);
  for (const int axis : {kAccelBiasY, kEgoWheel})
    estimate.P(axis, axis) += input.dt * input.noise[axis];
}

bool CEgoFilter::update(EgoEstimate& estimate, const EgoObservation& observation) {
  observation_ = observation;
  moving_ = false;
  run(estimate);
  return taken_;
}

void CEgoFilter::OnGetAction(KFArray_ACT& u) const { u[0] = input_.dt; }

void CEgoFilter::OnTransitionModel(const KFArray_ACT&, KFArray_VEH& x, bool& skip) const {
  skip = !moving_;
  EgoVector all = m_xkk.asEigen();
  all.head<kVehicle>() = x.asEigen();
  if (moving_) x.asEigen() = moved(all, input_).head<kVehicle>();
}

void CEgoFilter::OnTransitionJacobian(KFMatrix_VxV& F) const {
  F.asEigen() = jacobian(EgoVector(m_xkk.asEigen()), input_).topLeftCorner<kVehicle, kVehicle>();
}

void CEgoFilter::OnTransitionNoise(KFMatrix_VxV& Q) const {
  Q.setZero();
  Q.asEigen().diagonal() = input_.dt * input_.noise.head<kVehicle>();
}

void CEgoFilter::OnGetObservationNoise(KFMatrix_OxO& R) const {
  R.setZero();
  R.asEigen().diagonal() = observation_.variance;
}

void CEgoFilter::OnGetObservationsAndDataAssociation(vector_KFArray_OBS& z,
                                                     std::vector<int>& association,
                                                     const vector_KFArray_OBS& predictions,
                                                     const KFMatrix& S, const std::vector<size_t>&,
                                                     const KFMatrix_OxO&) {
  z.clear();
  association.clear();
  taken_ = false;
  if (observation_.rows == 0) return;
  KFArray_OBS seen;
  seen.asEigen() = observation_.z;
  KFArray_OBS innovation = seen;
  OnSubstractObservationVectors(innovation, predictions[0]);
  const Eigen::Vector3d y = innovation.asEigen();
  nis_ = y.dot(Eigen::Matrix3d(S.asEigen()).ldlt().solve(y));
  taken_ = std::isfinite(nis_) && (observation_.gate <= 0 || nis_ <= observation_.gate);
  if (!taken_) return;
  z.push_back(seen);
  association.push_back(0);
}

void CEgoFilter::OnObservationModel(const std::vector<size_t>&,
                                    vector_KFArray_OBS& predictions) const {
  predictions.resize(1);
  predictions[0].asEigen() = observation_.h;
}

void CEgoFilter::OnObservationJacobians(size_t, KFMatrix_OxV& Hx, KFMatrix_OxF& Hy) const {
  Hx.asEigen() = observation_.H.leftCols<kVehicle>();
  Hy.asEigen() = observation_.H.rightCols<2>();
}

void CEgoFilter::OnSubstractObservationVectors(KFArray_OBS& a, const KFArray_OBS& b) const {
  a -= b;
  if (observation_.angle) a[0] = wrapAngle(a[0]);
}

void CEgoFilter::OnNormalizeStateVector() {
  for (const int axis : {kEgoYaw, kEgoPitch, kEgoRoll}) m_xkk[axis] = wrapAngle(m_xkk[axis]);
}

// MRPT updates by P - K H P: symmetrized against accumulated rounding.
void CEgoFilter::OnPostIteration() {
  OnNormalizeStateVector();
  const EgoMatrix P = m_pkk.asEigen();
  m_pkk.asEigen() = 0.5 * (P + P.transpose());
}

}  // namespace perception
