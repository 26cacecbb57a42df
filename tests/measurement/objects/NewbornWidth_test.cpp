#include "libperception/measurement/objects/NewbornWidth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "libperception/core/math/Angle.h"

namespace perception {
namespace {

ClassTable vehiclesAndWalkers() {
  ClassTable classes;
  classes.classes.resize(2);
  ObjectClass &vehicle = classes.classes[0], &walker = classes.classes[1];
  vehicle.shape = ObjectShape::kVehicle, vehicle.motion = findMotionModel("wheeled");
  vehicle.length = 4.5, vehicle.length_sigma = 0.6, vehicle.width = 1.8, vehicle.width_sigma = 0.2;
  walker.shape = ObjectShape::kPedestrian, walker.motion = findMotionModel("constant-velocity");
  walker.length = walker.width = 0.5, walker.length_sigma = walker.width_sigma = 0.1;
  return classes;
}

TEST(NewbornWidth, WhatIsWiderThanTheLikeliestClassIsOnAverageCountsInFull) {
  const ClassTable classes = vehiclesAndWalkers();
  const ObjectClass& car = classes[0];
  const double mean = 2 / kPi * (car.length + car.width);
  const std::vector<double> a_car = {3, 0}, a_person = {-3, 0};
  EXPECT_EQ(NewbornWidth(classes, mean + 0.1, 0.01).gainOfShape(0, a_car), 1);
  EXPECT_LT(NewbornWidth(classes, mean - 0.1, 0.01).gainOfShape(0, a_car), 1);
  EXPECT_EQ(NewbornWidth(classes, mean - 0.1, 0.01).gainOfShape(0, a_person), 1)
      << "no person is that wide";
}

TEST(NewbornWidth, AThingMayBeAWallWhereTheShapeIsTold) {
  ClassTable classes = vehiclesAndWalkers();
  classes.classes.emplace_back();  // a thing of 1 m
  classes.classes.back().length = classes.classes.back().width = 1;
  classes.classes.back().length_sigma = classes.classes.back().width_sigma = 1;
  const auto density = [&](double width, bool by_shape, ClassId c) {
    return NewbornWidth(classes, width, 0.01, by_shape).density(c);
  };
  // A share of .12 from 3 to 10 m, which falls as one over the width.
  EXPECT_NEAR(density(5, true, 2), 0.12 / std::log(10 / 3.0) / 5, 1e-4);
  EXPECT_NEAR(density(9, true, 2) / density(4.5, true, 2), 0.5, 0.01);
  EXPECT_NEAR(density(5, false, 2), 0.001 / kWidestClutter, 1e-6);
  EXPECT_EQ(density(5, true, 0), density(5, false, 0)) << "no vehicle has any width";
}

TEST(NewbornWidth, IsADensity) {
  ClassTable classes = vehiclesAndWalkers();
  classes.classes.emplace_back();
  classes.classes.back().length = classes.classes.back().width = 1.5;
  classes.classes.back().length_sigma = classes.classes.back().width_sigma = 0.4;
  for (ClassId c = 0; c < 3; ++c) {
    double sum = 0;
    for (double width = 0.005; width < 10; width += 0.01)
      sum += 0.01 * NewbornWidth(classes, width, 0.01, true).density(c);
    EXPECT_NEAR(sum, 1, 0.01) << c;
  }
}

}  // namespace
}  // namespace perception
