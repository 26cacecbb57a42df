#pragma once
#include <mrpt/bayes/CKalmanFilterCapable.h>

#include "libperception/core/Frames.h"

namespace perception {

/// Components of the vehicle's state.
enum EgoAxis : int {
  kEgoX,
  kEgoY,
  kEgoZ,  ///< [m] world
  kEgoYaw,
  kEgoPitch,
  kEgoRoll,   ///< [rad] Rz(yaw) Ry(pitch) Rx(roll)
  kEgoSpeed,  ///< [m/s] of the rear axle, along the vehicle's x axis
  kEgoGyroX,
  kEgoGyroY,
  kEgoGyroZ,    ///< [rad/s] biases of the gyros
  kEgoAccel,    ///< [m/s^2] bias of the forward accelerometer
  kAccelBiasY,  ///< [m/s^2] bias of the sideways accelerometer
  kEgoWheel,    ///< [-] scale error: wheels read (1 + scale error) times the speed
  kEgoAxes
};
using EgoVector = Eigen::Matrix<double, kEgoAxes, 1>;
using EgoMatrix = Eigen::Matrix<double, kEgoAxes, kEgoAxes>;

inline constexpr double kGravity = 9.80665;  ///< [m/s^2] standard

/// The vehicle's state as a Gaussian.
struct EgoEstimate {
  EgoVector x = EgoVector::Zero();
  EgoMatrix P = EgoMatrix::Zero();

  Pose3 pose() const {
    return makePose(x[kEgoX], x[kEgoY], x[kEgoZ], x[kEgoYaw], x[kEgoPitch], x[kEgoRoll]);
  }
};

/// Input of one prediction step.
struct EgoInput {
  double dt = 0;                    ///< [s]
  Vector3 rates = Vector3::Zero();  ///< [rad/s] about the vehicle's axes, biases included
  bool gyro = false;                ///< the rates are of gyros: biases are subtracted
  double force = 0;                 ///< [m/s^2] specific force along x
  bool accelerometer = false;       ///< the force is measured: gravity and bias are subtracted
  double level_time = 0;  ///< [s] time constant with which pitch and roll decay to 0; 0: none
  EgoVector noise = EgoVector::Zero();  ///< variance per second, by component
};

/// An observation of up to three linearized rows.
struct EgoObservation {
  int rows = 0;  ///< in use
  Eigen::Vector3d z = Eigen::Vector3d::Zero(), h = Eigen::Vector3d::Zero();
  Eigen::Matrix<double, 3, kEgoAxes> H = Eigen::Matrix<double, 3, kEgoAxes>::Zero();
  Eigen::Vector3d variance = Eigen::Vector3d::Ones();
  bool angle = false;  ///< row 0 is an angle
  double gate = 0;     ///< largest NIS that is accepted; 0: no gate
};

/// The extended Kalman filter of the vehicle's own motion, executed by
/// mrpt::bayes::CKalmanFilterCapable (method.md 1.4). Unused rows of an observation have H = 0 and
/// zero innovation.
///
/// MRPT divides a state into a vehicle, which moves, and static landmarks. The last two components,
/// which are constants, form one landmark.
class CEgoFilter final : private mrpt::bayes::CKalmanFilterCapable<kAccelBiasY, 3, 2, 1> {
 public:
  CEgoFilter();

  void predict(EgoEstimate& estimate, const EgoInput& input);
  /// False when the gate rejected it: then nothing has changed.
  bool update(EgoEstimate& estimate, const EgoObservation& observation);
  double nis() const { return nis_; }  ///< of the last observation

  /// The motion model and its Jacobian.
  static EgoVector moved(const EgoVector& x, const EgoInput& input);
  static EgoMatrix jacobian(const EgoVector& x, const EgoInput& input);

 private:
  void run(EgoEstimate& estimate);
  void OnGetAction(KFArray_ACT& u) const override;
  void OnTransitionModel(const KFArray_ACT& u, KFArray_VEH& x, bool& skip) const override;
  void OnTransitionJacobian(KFMatrix_VxV& F) const override;
  void OnTransitionNoise(KFMatrix_VxV& Q) const override;
  void OnGetObservationNoise(KFMatrix_OxO& R) const override;
  void OnGetObservationsAndDataAssociation(vector_KFArray_OBS& z, std::vector<int>& association,
                                           const vector_KFArray_OBS& predictions, const KFMatrix& S,
                                           const std::vector<size_t>& indices,
                                           const KFMatrix_OxO& R) override;
  void OnObservationModel(const std::vector<size_t>& indices,
                          vector_KFArray_OBS& predictions) const override;
  void OnObservationJacobians(size_t index, KFMatrix_OxV& Hx, KFMatrix_OxF& Hy) const override;
  void OnSubstractObservationVectors(KFArray_OBS& a, const KFArray_OBS& b) const override;
  void OnNormalizeStateVector() override;
  void OnPostIteration() override;

  EgoInput input_;
  EgoObservation observation_;
  bool moving_ = false;  ///< this iteration predicts; otherwise it updates
  bool taken_ = false;
  double nis_ = 0;
};

}  // namespace perception
