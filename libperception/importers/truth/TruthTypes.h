#pragma once
#include <string>

namespace perception {

/// The truth's type (TruthObject::type) for a category of another data set, such as
/// "REGULAR_VEHICLE": KITTI's word where there is one (Car), else the category's own words in camel
/// case ("CONSTRUCTION_CONE": ConstructionCone).
std::string truthTypeOf(const std::string& category);

}  // namespace perception
