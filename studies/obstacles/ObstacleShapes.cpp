#include "studies/obstacles/ObstacleShapes.h"

#include <algorithm>

namespace perception {
namespace {

using Boxes = std::vector<ShapeBox>;

// Factors on the reflectivity of a wall (.4), for the materials of LidarSurface.
constexpr double kRubber = 0.15, kDark = 0.3, kCloth = 0.9, kFur = 0.7, kWood = 1.0, kSteel = 1.2,
                 kWhite = 1.5, kGreen = 0.9, kStone = 0.8;

Boxes together(const std::vector<Boxes>& parts) {
  Boxes all;
  for (const Boxes& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

Boxes person(double x = 0, double y = 0, double cloth = kCloth) {
  return {{x, y - 0.11, 0, 0.2, 0.15, 0.85, kDark},
          {x + 0.1, y + 0.11, 0, 0.2, 0.15, 0.85, kDark},
          {x, y, 0.85, 0.26, 0.46, 0.62, cloth},
          {x + 0.03, y, 1.5, 0.2, 0.18, 0.24, 1.2}};
}

Boxes child(double x = 0, double y = 0, double tall = 1.05) {
  return {{x, y, 0, 0.16, 0.22, 0.45 * tall, kDark},
          {x, y, 0.45 * tall, 0.18, 0.28, 0.35 * tall, kCloth},
          {x, y, 0.8 * tall, 0.17, 0.17, 0.2 * tall, 1.2}};
}

Boxes wheels(double x, double half_track, double base_length, double radius) {
  Boxes all;
  for (const double along : {x, x + base_length})
    for (const double across : {-half_track, half_track})
      all.push_back({along, across, 0, 2 * radius, 0.25, 2 * radius, kRubber});
  return all;
}

// A trunk on four legs, seen from its side or its tail: `along` lies in the lane's direction.
Boxes animal(double length, double width, double legs, double body, bool along) {
  const double l = along ? length : width, w = along ? width : length;
  Boxes all = {{0, 0, legs, l, w, body, kFur}};
  for (const double dx : {0.0, l - 0.1})
    for (const double dy : {-0.5 * w + 0.05, 0.5 * w - 0.05})
      all.push_back({dx, dy, 0, 0.1, 0.1, legs, kFur});
  const double head = 0.25 * length;
  if (along)
    all.push_back({l, 0, legs + 0.5 * body, head, 0.7 * width, 0.6 * body, kFur});
  else
    all.push_back(
        {0.1 * l, 0.5 * w + 0.5 * head, legs + 0.5 * body, 0.7 * l, head, 0.6 * body, kFur});
  return all;
}

// Bars of one size side by side.
Boxes fence(int bars, double spacing, double bar, double base, double height, double factor) {
  Boxes all;
  for (int i = 0; i < bars; ++i)
    all.push_back({0, spacing * (i - 0.5 * (bars - 1)), base, bar, bar, height, factor});
  return all;
}

// A beam that rises to the left, as stairs of short boxes.
Boxes risingArm(double base, double rise, int steps) {
  Boxes all;
  for (int i = 0; i < steps; ++i)
    all.push_back({0, -2.0 + 0.4 * i, base + rise * i, 0.08, 0.4, 0.12, kWhite});
  return all;
}

// Twigs: small boxes scattered by a fixed rule.
Boxes twigs(double length, double width, double base, double height, int count) {
  Boxes all;
  for (int i = 0; i < count; ++i) {
    const double a = 0.618034 * i - static_cast<int>(0.618034 * i);
    const double b = 0.754878 * i - static_cast<int>(0.754878 * i);
    const double c = 0.569840 * i - static_cast<int>(0.569840 * i);
    all.push_back(
        {length * a, width * (b - 0.5), base + height * c, 0.12, 0.12, 0.06, kGreen, 360 * a});
  }
  return all;
}

std::vector<ObstacleShape> people() {
  const std::string kind = "people";
  const auto stop = ShapeDemand::kStop;
  return {
      {"person standing", kind, stop, person()},
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
       {{0, 0, 0, 0.2, 0.35, 0.85, kDark}, {0, 0, 0.75, 0.8, 0.45, 0.3, kCloth}}},
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
           {{0, 0, 0, 0.3, 0.3, 2.5, kWood}, {-1, 0, 2.5, 2.3, 2.3, 2, kGreen}}},
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
    for (const auto& some : {people(), animals(), goods(), plants(), vehicles(), barriers(),
                             hanging(), lowAndBeside()})
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
