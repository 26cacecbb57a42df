#include "studies/obstacles/ObstacleShapes.h"

#include <algorithm>

#include "studies/obstacles/ShapeParts.h"

namespace perception {
namespace {

using namespace shape_parts;

std::vector<ObstacleShape> goods() {
  const std::string kind = "goods";
  const auto stop = ShapeDemand::kStop;
  return {{"pallet", kind, ShapeDemand::kLow, {{0, 0, 0, 0.8, 1.2, 0.144, kWood}}},
          {"stack of four pallets", kind, stop, {{0, 0, 0, 0.8, 1.2, 0.576, kWood}}},
          {"pallet on edge", kind, stop, {{0, 0, 0, 0.144, 1.2, 0.8, kWood}}},
          {"drum", kind, stop, {{0, 0, 0, 0.58, 0.58, 0.88, kSteel}}},
          {"drum lying", kind, stop, {{0, 0, 0, 0.58, 0.88, 0.58, kSteel}}},
          {"crate", kind, stop, {{0, 0.3, 0, 0.4, 0.6, 0.42, kWood, 20}}},
          {"cardboard box", kind, stop, {{0, -0.5, 0, 0.3, 0.4, 0.38, kWood, -15}}},
          {"mattress on edge", kind, stop, {{0, 0, 0, 0.2, 1.9, 0.9, kWhite}}},
          {"mattress lying", kind, ShapeDemand::kLow, {{0, 0, 0, 2, 1.4, 0.2, kWhite}}},
          {"sofa",
           kind,
           stop,
           {{0, 0, 0, 0.6, 1.9, 0.42, kCloth}, {0.6, 0, 0, 0.25, 1.9, 0.85, kCloth}}},
          {"refrigerator lying", kind, stop, {{0, 0, 0, 0.6, 1.7, 0.6, kWhite, 30}}},
          {"suitcase", kind, stop, {{0, 0.6, 0, 0.3, 0.5, 0.75, kDark}}},
          {"dustbin", kind, stop, {{0, 0, 0, 0.7, 0.58, 1.07, kDark}}},
          {"shopping cart", kind, stop,
           together({fence(8, 0.08, 0.01, 0.4, 0.6, kSteel),
                     {{0, 0, 0.4, 0.9, 0.56, 0.02, kSteel}, {0.9, 0, 0.95, 0.04, 0.5, 0.04, kDark}},
                     wheels(0, 0.25, 0.7, 0.06)})},
          {"pile of sacks",
           kind,
           stop,
           {{0, 0, 0, 0.6, 1.2, 0.2, kStone},
            {0.05, 0, 0.2, 0.5, 0.9, 0.2, kStone},
            {0.1, 0.1, 0.4, 0.4, 0.5, 0.15, kStone}}},
          {"pipe across", kind, stop, {{0, 0, 0, 0.4, 3, 0.4, kStone}}},
          {"logs",
           kind,
           stop,
           {{0, 0, 0, 0.35, 2.5, 0.35, kWood, 10},
            {0.4, 0.2, 0, 0.35, 2.5, 0.35, kWood, -5},
            {0.2, 0.1, 0.35, 0.35, 2.5, 0.3, kWood}}},
          {"boulder", kind, stop, {{0, 0.2, 0, 0.5, 0.55, 0.5, kStone, 35}}},
          {"heap of gravel",
           kind,
           stop,
           {{0, 0, 0, 2, 2.4, 0.2, kStone},
            {0.3, 0, 0.2, 1.4, 1.7, 0.25, kStone},
            {0.6, 0, 0.45, 0.8, 0.9, 0.25, kStone}}},
          {"ladder lying", kind, ShapeDemand::kLow, {{0, 0, 0, 0.4, 3, 0.08, kSteel}}},
          {"tire standing", kind, stop, {{0, -0.3, 0, 0.22, 0.65, 0.65, kRubber}}},
          {"tire lying", kind, ShapeDemand::kLow, {{0, 0, 0, 0.65, 0.65, 0.22, kRubber}}},
          {"lorry's tire lying", kind, stop, {{0, 0, 0, 1.05, 1.05, 0.38, kRubber}}}};
}

std::vector<ObstacleShape> plants() {
  const std::string kind = "plants";
  const auto stop = ShapeDemand::kStop;
  return {{"tree standing",
           kind,
           stop,
           {{0, 0, 0, 0.3, 0.3, 2.5, kWood}, {-1, 0, 2.5, 2.3, 2.3, 2, kLeaves}}},
          {"trunk across", kind, stop, {{0, 0, 0, 0.5, 4.5, 0.5, kWood, 12}}},
          {"tree fallen with its crown", kind, stop,
           together({{{1.2, 0.8, 0, 0.35, 3.5, 0.4, kWood}}, twigs(2.5, 2.4, 0.1, 1.6, 160)})},
          {"branch lying", kind, stop, twigs(1.2, 1.8, 0.05, 0.55, 60)},
          {"tumbled bush", kind, stop, twigs(0.9, 0.9, 0.05, 0.8, 90)}};
}

std::vector<ObstacleShape> vehicles() {
  const std::string kind = "vehicles";
  const auto stop = ShapeDemand::kStop;
  return {
      {"lorry's side", kind, stop,
       together({{{0, 0, 1.1, 2.45, 5.2, 2.7, kWhite}},
                 {{0.1, -2, 0, 1, 1, 1, kRubber}, {0.1, 1.6, 0, 1, 1, 1, kRubber}}})},
      {"lorry's tail", kind, stop,
       together({{{0, 0, 1.05, 8, 2.5, 2.7, kWhite}}, wheels(1.2, 1.1, 5, 0.5)})},
      {"flatbed's overhang", kind, stop,
       together({{{0, 0, 1.1, 7, 2.4, 0.2, kDark}}, wheels(2.8, 1.05, 3, 0.48)})},
      {"load beyond a tail", kind, stop,
       together({{{0, 0.3, 1.3, 3, 0.3, 0.2, kWood}, {2, 0, 0.9, 4, 2.2, 0.6, kDark}},
                 wheels(2.4, 0.95, 2.5, 0.4)})},
      {"trailer and its drawbar", kind, stop,
       together({{{0, 0, 0.4, 1.6, 0.1, 0.1, kSteel}, {1.6, 0, 0.4, 2.5, 1.6, 0.5, kSteel}},
                 {{2.4, -0.9, 0, 0.6, 0.2, 0.6, kRubber}, {2.4, 0.9, 0, 0.6, 0.2, 0.6, kRubber}}})},
      {"drawbar across",
       kind,
       stop,
       {{0, 0.4, 0.42, 0.1, 2.8, 0.12, kSteel}, {0, 0.6, 0, 0.08, 0.08, 0.42, kSteel}}},
      {"car across",
       kind,
       stop,
       {{0, 0, 0.25, 1.8, 4.4, 0.6, kSteel}, {0.2, 0.1, 0.85, 1.4, 2.2, 0.55, kDark}}},
      {"car on its roof",
       kind,
       stop,
       {{0.2, 0, 0, 1.4, 2, 0.45, kDark, 30}, {0, 0, 0.45, 1.8, 4.2, 0.6, kDark, 30}}},
      {"motorcycle lying",
       kind,
       stop,
       {{0, 0, 0, 0.5, 1.2, 0.45, kDark}, {0.1, -0.8, 0, 0.6, 0.5, 0.3, kRubber}}},
      {"bicycle lying",
       kind,
       stop,
       {{0, -0.5, 0.02, 0.65, 0.65, 0.05, kRubber},
        {0, 0.5, 0.02, 0.65, 0.65, 0.05, kRubber},
        {0.2, 0, 0.05, 0.05, 0.9, 0.08, kSteel},
        {0.1, 0.45, 0, 0.05, 0.05, 0.55, kSteel},
        {0.1, -0.1, 0, 0.1, 0.1, 0.45, kDark}}},
      {"forks raised",
       kind,
       stop,
       {{0, -0.3, 0.55, 1.1, 0.12, 0.05, kSteel},
        {0, 0.3, 0.55, 1.1, 0.12, 0.05, kSteel},
        {1.1, 0, 0.1, 2, 1.1, 1.9, kStone}}},
      {"excavator's arm",
       kind,
       stop,
       {{0, 0, 0.7, 0.5, 0.9, 0.6, kSteel}, {0.1, 0, 1.3, 0.3, 0.3, 2.5, kSteel}}}};
}

std::vector<ObstacleShape> barriers() {
  const std::string kind = "barriers";
  const auto stop = ShapeDemand::kStop;
  return {
      {"bar of 10 cm at .6 m", kind, stop, {{0, 0, 0.6, 0.1, 2.6, 0.1, kWood}}},
      {"boom at 1 m", kind, stop, {{0, 0, 1, 0.1, 5.2, 0.12, kWhite}}},
      {"barrier arm with a skirt", kind, stop, {{0, 0, 0.9, 0.3, 5.2, 1.2, kWhite}}},
      {"barrier arm rising", kind, stop, risingArm(0.9, 0.12, 11)},
      {"rope across", kind, stop, {{0, 0, 0.7, 0.03, 5.2, 0.03, kCloth}}},
      {"gate of bars", kind, stop,
       together({fence(12, 0.22, 0.03, 0.15, 1.3, kSteel),
                 {{0, 0, 0.15, 0.05, 2.6, 0.05, kSteel}, {0, 0, 1.4, 0.05, 2.6, 0.05, kSteel}}})},
      {"trestle",
       kind,
       stop,
       {{0, 0, 0.75, 0.05, 1.5, 0.25, kWhite},
        {-0.2, -0.6, 0, 0.4, 0.05, 0.75, kWhite},
        {-0.2, 0.6, 0, 0.4, 0.05, 0.75, kWhite}}},
      {"concrete barrier",
       kind,
       stop,
       {{0, 0, 0, 0.6, 3, 0.3, kStone}, {0.15, 0, 0.3, 0.3, 3, 0.5, kStone}}},
      {"cone",
       kind,
       stop,
       {{0, 0, 0, 0.38, 0.38, 0.04, kDark},
        {0.06, 0, 0.04, 0.26, 0.26, 0.25, kWhite},
        {0.1, 0, 0.29, 0.18, 0.18, 0.25, kWhite},
        {0.14, 0, 0.54, 0.1, 0.1, 0.2, kWhite}}},
      {"bollard", kind, stop, {{0, 0.2, 0, 0.15, 0.15, 0.9, kSteel}}}};
}

std::vector<ObstacleShape> hanging() {
  const std::string kind = "hanging";
  const auto stop = ShapeDemand::kStop, pass = ShapeDemand::kPass;
  return {{"beam at 1.5 m", kind, stop, {{0, 0.2, 1.5, 4, 0.2, 0.2, kWood}}},
          {"beam across at 1.6 m", kind, stop, {{0, 0, 1.6, 0.2, 5, 0.25, kSteel}}},
          {"load on a crane",
           kind,
           stop,
           {{0, 0, 1.1, 0.8, 0.8, 0.8, kSteel}, {0.38, 0, 1.9, 0.03, 0.03, 4, kSteel}}},
          {"bough at 1.3 m", kind, stop, twigs(1.5, 2.4, 1.3, 1.2, 140)},
          {"panel dangling", kind, stop, {{0, 0.4, 0.9, 0.05, 0.9, 1.6, kWhite, 15}}},
          {"ceiling at 1.8 m", kind, stop, {{0, 0, 1.8, 6, 5, 0.3, kStone}}},
          {"bough at 2.7 m", kind, pass, twigs(1.5, 2.4, 2.7, 1.2, 140)},
          {"gantry",
           kind,
           pass,
           {{0, 0, 4.7, 0.5, 8, 0.8, kSteel},
            {0, -4.2, 0, 0.4, 0.4, 5.5, kSteel},
            {0, 4.2, 0, 0.4, 0.4, 5.5, kSteel}}},
          {"garage's ceiling at 2.3 m", kind, pass, {{0, 0, 2.3, 30, 8, 0.3, kStone}}}};
}

std::vector<ObstacleShape> lowAndBeside() {
  const auto low = ShapeDemand::kLow, pass = ShapeDemand::kPass;
  return {{"hose", "low", low, {{0, 0, 0, 0.05, 5, 0.05, kDark}}},
          {"cable bridge", "low", low, {{0, 0, 0, 0.6, 4, 0.07, kRubber}}},
          {"bar of 10 cm lying", "low", low, {{0, 0, 0, 0.1, 2.5, 0.1, kWood}}},
          {"kerb", "low", low, {{0, 0, 0, 0.3, 5, 0.14, kStone}}},
          {"empty road", "beside", pass, {}},
          {"parked car beside", "beside", pass, {{0, -2.8, 0.2, 4.4, 1.8, 1.25, kSteel}}},
          {"people beside", "beside", pass, together({person(0, 2.2), person(0.8, 2.6)})},
          {"cones to both sides",
           "beside",
           pass,
           {{0, -1.9, 0, 0.25, 0.25, 0.75, kWhite}, {0, 1.9, 0, 0.25, 0.25, 0.75, kWhite}}},
          {"barrier arm open", "beside", pass, {{0, 2.3, 0.9, 0.1, 0.12, 4.5, kWhite}}}};
}

}  // namespace

const std::vector<ObstacleShape>& obstacleShapes() {
  static const std::vector<ObstacleShape> shapes = [] {
    std::vector<ObstacleShape> all;
    for (const auto& some :
         {livingShapes(), goods(), plants(), vehicles(), barriers(), hanging(), lowAndBeside()})
      all.insert(all.end(), some.begin(), some.end());
    return all;
  }();
  return shapes;
}

double topOf(const ObstacleShape& shape) {
  double top = 0;
  for (const ShapeBox& box : shape.boxes) top = std::max(top, box.base + box.height);
  return top;
}

}  // namespace perception
