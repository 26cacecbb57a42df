#include "gui-offscreen/html/RunData.h"

#include <gtest/gtest.h>
#include <zlib.h>

#include "gui-offscreen/html/PageBundle.h"

namespace perception {
namespace {

TrackedRun twoScenes() {
  TrackedRun run;
  run.first_stamp = Stamp::fromSeconds(1000);
  run.class_names = {"car", "static-other"};
  for (int k = 0; k < 2; ++k) {
    Scene scene;
    scene.stamp = run.first_stamp + 0.1 * k;
    scene.ego.T_world_ego.translation() = Vector3(5e5 + k, 4e6, 100);
    SceneObject car;
    car.id = 7;
    car.classified = k == 1;
    car.class_probability = {0.9, 0.1};
    car.position = Vector3(5e5 + 20, 4e6 - 3.14159, 100);
    car.velocity = Vector2(10, 0);
    car.last_hit[Modality::kLidar] = run.first_stamp;
    scene.objects = {car};
    run.scenes.push_back(scene);
  }
  return run;
}

SceneView returnsOn(const TrackedRun& run, std::size_t k, int count) {
  SceneView view;
  for (int i = 0; i < count; ++i) {
    ViewPoint point;
    point.place = run.scenes[k].ego.T_world_ego.translation() + Vector3(0.01 * i, -2, 1);
    point.height = 1;
    point.trust = i % 2 ? 1.0F : 0.0F;
    view.points.push_back(point);
  }
  return view;
}

std::int16_t at16(const std::string& bytes, std::size_t at) {
  return static_cast<std::int16_t>(static_cast<std::uint8_t>(bytes[at]) |
                                   static_cast<std::uint8_t>(bytes[at + 1]) << 8);
}

TEST(RunData, TracksAreColumnsByObjectFromTheFirstPlaceOfTheVehicle) {
  const TrackedRun run = twoScenes();
  RunRecord record;
  record.hash = "abc";
  const RunData data(run, record);
  const auto& json = data.collected();
  EXPECT_EQ(json["id"], "abc");
  ASSERT_EQ(json["objects"].size(), 1u);
  const auto& car = json["objects"][0];
  EXPECT_EQ(car["id"], 7);
  EXPECT_EQ(car["k"], nlohmann::json({0, 1}));
  EXPECT_EQ(car["sure"], nlohmann::json({0, 1}));
  EXPECT_EQ(car["hits"]["L"].size(), 1u) << "one measurement, seen from two scenes";
  EXPECT_DOUBLE_EQ(car["row"][0][0].get<double>(), 20);
  EXPECT_DOUBLE_EQ(car["row"][0][1].get<double>(), -3.14);
  EXPECT_DOUBLE_EQ(json["scenes"][1]["ego"][0].get<double>(), 1);
}

TEST(RunData, ScenesOfALiveRunKeepTheOriginThatIsGiven) {
  TrackedRun run = twoScenes();
  const Vector3 first = run.scenes[0].ego.T_world_ego.translation();
  run.scenes.erase(run.scenes.begin());
  const RunData data(run, {}, {}, first);
  EXPECT_DOUBLE_EQ(data.collected()["scenes"][0]["ego"][0].get<double>(), 1);
  EXPECT_DOUBLE_EQ(data.collected()["objects"][0]["row"][0][0].get<double>(), 20);
}

TEST(RunData, ReturnsAreCentimetersFromTheVehicle) {
  const TrackedRun run = twoScenes();
  RunData data(run, {});
  data.add(1, returnsOn(run, 1, 3));
  ASSERT_EQ(data.bytes().size(), 3u * 8);
  EXPECT_EQ(data.collected()["scenes"][1]["block"], nlohmann::json({0, 3, 0}));
  EXPECT_EQ(at16(data.bytes(), 4), 2) << "x of the third";
  EXPECT_EQ(at16(data.bytes(), 6), -200) << "y of the first";
  EXPECT_EQ(static_cast<std::uint8_t>(data.bytes()[18]), 50) << "height in steps of 2 cm";
  EXPECT_EQ(static_cast<std::uint8_t>(data.bytes()[21]), 0) << "trust of the first";
  EXPECT_EQ(static_cast<std::uint8_t>(data.bytes()[22]), 255);
}

TEST(RunData, ReturnsAreThinnedEvenlyToTheBudget) {
  const TrackedRun run = twoScenes();
  RunData::Budget budget;
  budget.points = 40'000;
  RunData data(run, {}, budget);
  for (std::size_t k = 0; k < 2; ++k) data.add(k, returnsOn(run, k, 30'000));
  EXPECT_EQ(data.pointsSeen(), 60'000u);
  EXPECT_GT(data.pointsKept(), 2000u);
  EXPECT_LT(data.bytes().size() * 4 / 3, budget.points);
  const std::size_t kept = data.pointsKept() / 2;
  EXPECT_NEAR(at16(data.bytes(), 2 * (kept / 2)), 15'000, 20) << "the middle one of 300 m";
}

TEST(RunData, ReturnsTooFarForSixteenBitsAreLeftOut) {
  const TrackedRun run = twoScenes();
  RunData data(run, {});
  SceneView view = returnsOn(run, 0, 2);
  view.points[0].place.x() += 500;
  data.add(0, view);
  EXPECT_EQ(data.pointsKept(), 1u);
}

TEST(RunData, ErrorsAreColumnsOfTheirObject) {
  const TrackedRun run = twoScenes();
  RunErrors errors(2);
  TruthErrors& error = errors[1][7];
  error.truth = 3;
  error.position = 0.256;
  error.heading = -0.5;
  error.right_class = true;
  RunData data(run, {});
  data.setErrors(errors);
  EXPECT_EQ(data.collected()["objects"][0]["err"].dump(), "[null,[3,0.26,null,-0.5,1]]");
}

TEST(Gzipped, IsReadBack) {
  const std::string text = "what comes out is what went in, what comes out is what went in";
  const std::string packed = gzipped(text);
  std::string back(text.size(), ' ');
  z_stream z{};
  ASSERT_EQ(inflateInit2(&z, 15 + 16), Z_OK);
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
  z.avail_in = static_cast<uInt>(packed.size());
  z.next_out = reinterpret_cast<Bytef*>(back.data());
  z.avail_out = static_cast<uInt>(back.size());
  EXPECT_EQ(inflate(&z, Z_FINISH), Z_STREAM_END);
  inflateEnd(&z);
  EXPECT_EQ(back, text);
  EXPECT_LT(packed.size(), text.size());
}

TEST(PageBundle, IsWholeAndLoadsNothing) {
  const std::string script(pageScript());
  EXPECT_GT(script.size(), 300'000u);
  EXPECT_EQ(script.find("</script"), std::string::npos);
  EXPECT_NE(script.find("perceptionViewers"), std::string::npos);
  EXPECT_NE(std::string(pageStyle()).find(".stage"), std::string::npos);
  EXPECT_EQ(std::string(pageStyle()).find("url("), std::string::npos);
}

}  // namespace
}  // namespace perception
