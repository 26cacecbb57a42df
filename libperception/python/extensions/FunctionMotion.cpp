#include "libperception/python/extensions/FunctionMotion.h"

#include <map>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "libperception/core/Error.h"
#include "libperception/core/math/KalmanUpdate.h"
#include "libperception/measurement/objects/MotionModel.h"
#include "libperception/measurement/objects/ObjectClass.h"

namespace perception {
namespace {

/// By row. Never destroyed: a function of Python must not outlive Python.
struct MotionFunctions {
  std::shared_mutex mutex;
  std::map<const MotionModel*, std::shared_ptr<const MotionFunction>> of;
};

MotionFunctions& motionFunctions() {
  static auto* const functions = new MotionFunctions;
  return *functions;
}

void predictByFunction(const GaussianStep& step, Matrix4* transition) {
  const MotionModel* row = step.object_class->motion;
  if (row->has_heading && !step.oriented)
    return findMotionModel("constant-velocity")->predict(step, transition);
  std::shared_ptr<const MotionFunction> function;
  {
    const std::shared_lock reading(motionFunctions().mutex);
    function = motionFunctions().of.at(row);
  }
  const MotionPrediction predicted = (*function)(*step.x, step.dt, step.psd);
  *step.x = predicted.x;
  *step.P = predicted.F * *step.P * predicted.F.transpose() + predicted.Q;
  symmetrize(*step.P);
  if (transition) *transition = predicted.F;
}

}  // namespace

void addMotionModel(const std::string& name, bool has_heading, MotionFunction predict) {
  const MotionModel* row = findMotionModel(name);
  MotionFunctions& functions = motionFunctions();
  const std::unique_lock writing(functions.mutex);
  if (name.empty() || (row && functions.of.count(row) == 0))
    throw Error(ExitCode::kUsage, "motion model '" + name + "': there is one of this name already");
  if (row && row->has_heading != has_heading)
    throw Error(ExitCode::kUsage,
                "motion model '" + name + "': has_heading is not that of the first of this name");
  if (!row) {
    const MotionModel* like = findMotionModel(has_heading ? "wheeled" : "constant-velocity");
    motionModels().push_back(
        {name, true, has_heading, &predictByFunction, like->kinematics, nullptr});
    row = &motionModels().back();
  }
  functions.of[row] = std::make_shared<const MotionFunction>(std::move(predict));
}

}  // namespace perception
