#include <string>
#include <vector>

#include "studies/obstacles/ObstacleShapes.h"
#include "studies/obstacles/ShapeParts.h"

namespace perception {
namespace {

using namespace shape_parts;

/// One person: standing, lying, sitting, bent.
std::vector<ObstacleShape> persons() {
  const std::string kind = "people";
  const auto stop = ShapeDemand::kStop;
  return {{"person standing", kind, stop, person()},
          {"child of six", kind, stop, child()},
          {"toddler", kind, stop, child(0, 0, 0.8)},
          {"person in black", kind, stop, person(0, 0, kDark)},
          {"person lying on the back",
           kind,
           ShapeDemand::kLow,
           {{0, -0.7, 0, 0.3, 0.85, 0.16, kDark},
            {0, 0.05, 0, 0.46, 0.65, 0.24, kCloth},
            {0.1, 0.5, 0, 0.18, 0.24, 0.22, 1.2}}},
          {"person lying on the side",
           kind,
           stop,
           {{0, -0.75, 0, 0.2, 0.85, 0.2, kDark},
            {0, -0.2, 0, 0.28, 0.35, 0.36, kCloth},
            {0, 0.25, 0, 0.26, 0.55, 0.44, kCloth},
            {0, 0.65, 0.05, 0.2, 0.24, 0.2, 1.2}}},
          {"person lying along the lane",
           kind,
           stop,
           {{0, 0, 0, 0.8, 0.35, 0.2, kDark}, {0.8, 0, 0, 0.7, 0.46, 0.4, kCloth}}},
          {"person crouching",
           kind,
           stop,
           {{0, 0, 0, 0.5, 0.45, 0.6, kCloth}, {0.1, 0, 0.6, 0.2, 0.2, 0.25, 1.2}}},
          {"person kneeling",
           kind,
           stop,
           {{0.1, 0, 0, 0.6, 0.4, 0.3, kDark},
            {0.2, 0, 0.3, 0.26, 0.45, 0.6, kCloth},
            {0.2, 0, 0.9, 0.2, 0.18, 0.24, 1.2}}},
          {"person sitting on the road",
           kind,
           stop,
           {{0, 0, 0, 0.7, 0.4, 0.2, kDark}, {0.7, 0, 0, 0.3, 0.45, 0.85, kCloth}}},
          {"person bent over",
           kind,
           stop,
           {{0, 0, 0, 0.2, 0.35, 0.85, kDark}, {0, 0, 0.75, 0.8, 0.45, 0.3, kCloth}}}};
}

std::vector<ObstacleShape> groupsAndPersonsWithThings() {
  const std::string kind = "people";
  const auto stop = ShapeDemand::kStop;
  return {
      {"person with an umbrella", kind, stop,
       together({person(0.4), {{0, 0, 1.85, 1.1, 1.1, 0.12, kDark}}})},
      {"person with a ladder", kind, stop,
       together({person(), {{-0.1, 0, 1.3, 0.05, 2.5, 0.35, kSteel}}})},
      {"two people", kind, stop, together({person(0, -0.35), person(0.1, 0.35)})},
      {"group of five", kind, stop,
       together({person(0, -0.9), person(0.5, -0.3), person(0.1, 0.2), person(0.7, 0.6),
                 child(0.3, 1.0)})},
      {"wheelchair", kind, stop,
       together({{{0, 0, 0.45, 0.5, 0.5, 0.1, kDark},
                  {0.4, 0, 0.5, 0.25, 0.45, 0.6, kCloth},
                  {0.45, 0, 1.1, 0.2, 0.18, 0.24, 1.2},
                  {0.1, -0.3, 0, 0.6, 0.05, 0.6, kRubber},
                  {0.1, 0.3, 0, 0.6, 0.05, 0.6, kRubber}}})},
      {"pram pushed", kind, stop,
       together({person(0.9), {{0, 0, 0.5, 0.8, 0.4, 0.5, kDark}}, wheels(0, 0.22, 0.6, 0.12)})},
      {"pram alone", kind, stop,
       together({{{0, 0, 0.5, 0.8, 0.4, 0.5, kCloth}}, wheels(0, 0.22, 0.6, 0.12)})},
      {"person with a walking frame", kind, stop,
       together({person(0.45), fence(2, 0.55, 0.05, 0, 0.9, kSteel)})},
      {"child on a scooter", kind, stop,
       together({child(0.3, 0, 1.2), {{0, 0, 0, 0.05, 0.05, 0.9, kSteel}}})}};
}

std::vector<ObstacleShape> animals() {
  const std::string kind = "animals";
  const auto stop = ShapeDemand::kStop;
  return {{"large dog across", kind, stop, animal(0.8, 0.28, 0.35, 0.32, false)},
          {"large dog along", kind, stop, animal(0.8, 0.28, 0.35, 0.32, true)},
          {"small dog", kind, stop, animal(0.45, 0.18, 0.15, 0.25, false)},
          {"cat", kind, ShapeDemand::kLow, animal(0.4, 0.14, 0.1, 0.14, false)},
          {"hedgehog", kind, ShapeDemand::kLow, {{0, 0, 0, 0.15, 0.22, 0.15, kFur}}},
          {"roe deer", kind, stop, animal(1.0, 0.3, 0.45, 0.35, false)},
          {"red deer along", kind, stop, animal(1.6, 0.45, 0.8, 0.55, true)},
          {"boar", kind, stop, animal(1.2, 0.4, 0.3, 0.5, false)},
          {"sheep", kind, stop, animal(0.9, 0.4, 0.3, 0.45, true)},
          {"cow", kind, stop, animal(2.0, 0.7, 0.6, 0.8, false)},
          {"horse", kind, stop, animal(2.0, 0.55, 0.85, 0.7, true)},
          {"swan",
           kind,
           stop,
           {{0, 0, 0, 0.7, 0.35, 0.4, kWhite}, {0, 0, 0.4, 0.1, 0.1, 0.5, kWhite}}}};
}

}  // namespace

std::vector<ObstacleShape> livingShapes() {
  std::vector<ObstacleShape> all;
  for (const auto& some : {persons(), groupsAndPersonsWithThings(), animals()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace perception
