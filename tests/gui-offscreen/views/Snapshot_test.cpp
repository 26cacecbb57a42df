#include "gui-offscreen/views/Snapshot.h"

#include <gtest/gtest.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <cstdlib>
#include <filesystem>

#include "gui-offscreen/views/ContactSheet.h"
#include "gui-offscreen/views/SceneFile.h"
#include "libperception/core/Error.h"
#include "tests/gui-offscreen/ViewFixture.h"

namespace perception {
namespace {

using test::emptyView;
using test::objectAt;
using test::snapshot;

/// Share of the picture's pixels that differ.
double difference(const Picture& a, const Picture& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < a.rgb.size(); i += 3) {
    different +=
        a.rgb[i] != b.rgb[i] || a.rgb[i + 1] != b.rgb[i + 1] || a.rgb[i + 2] != b.rgb[i + 2];
  }
  return static_cast<double>(different) / static_cast<double>(a.width * a.height);
}

/// Middle of the pixels that are clearly red [px].
Vector2 redMiddle(const Picture& picture, std::size_t& count) {
  Vector2 sum = Vector2::Zero();
  count = 0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const std::uint8_t* p = picture.at(x, y);
      if (p[0] < p[1] + 35 || p[0] < p[2] + 60) continue;
      sum += Vector2(x + 0.5, y + 0.5);
      ++count;
    }
  }
  return count ? Vector2(sum / static_cast<double>(count)) : sum;
}

TEST(ViewCamera, TopViewShowsForwardUpAndLeftLeft) {
  const ViewCamera camera = ViewCamera::top(40, 1000, 700);
  const Vector2 ego = *camera.project({0, 0, 0}), ahead = *camera.project({40, 0, 0});
  const Vector2 left = *camera.project({0, 10, 0});
  EXPECT_NEAR(ego.x(), 500, 1e-9);
  EXPECT_NEAR(ahead.y(), 0, 1e-6);
  EXPECT_NEAR(ego.y() - ahead.y(), 40 * camera.scaleAt({0, 0, 0}), 1e-6);
  EXPECT_NEAR(ego.x() - left.x(), 10 * camera.scaleAt({0, 0, 0}), 1e-6);
  EXPECT_NEAR(left.y(), ego.y(), 1e-9);
}

TEST(ViewCamera, DriverSeesLeftOnTheLeftAndNothingBehind) {
  const ViewCamera camera = ViewCamera::driver(40, 1000, 700);
  const Vector2 ahead = *camera.project({20, 0, 0}), left = *camera.project({20, 5, 0});
  EXPECT_NEAR(ahead.x(), 500, 1e-9);
  EXPECT_LT(left.x(), ahead.x());
  EXPECT_LT(camera.project({40, 0, 0})->y(), ahead.y());
  EXPECT_FALSE(camera.project({-30, 0, 0}));
}

TEST(ViewCamera, LinesAreCutAtTheNearPlane) {
  const ViewCamera camera = ViewCamera::driver(40, 1000, 700);
  const auto line = camera.projectLine(Vector3(-50, 0, 0), Vector3(20, 0, 0));
  ASSERT_EQ(line.size(), 1U);
  EXPECT_TRUE(line[0].first.allFinite());
  EXPECT_TRUE(camera.projectLine(Vector3(-50, 0, 0), Vector3(-40, 0, 0)).empty());
}

/// The rendered place of a return against the projected one: text and lines stand where OpenGL
/// draws. One view after the other with the same framebuffer.
TEST(Renderer, DrawsAtThePlaceThatTheCameraProjects) {
  const int width = snapshot().viewWidth(), height = snapshot().viewHeight();
  for (const ViewKind kind : {ViewKind::kTop, ViewKind::kDriver}) {
    for (const Vector3& place : {Vector3(25, 12, 0.5), Vector3(8, -4, 1.5)}) {  // ego frame
      SceneView view = emptyView();
      SceneObject marker = objectAt(1, 0, 0, 0);  // a pedestrian is red
      marker.position = view.scene.ego.T_world_ego * place;
      marker.length = marker.width = marker.height = 0.5;
      marker.existence = 1;
      view.scene.objects = {marker};
      const ViewCamera camera = kind == ViewKind::kTop ? ViewCamera::top(40, width, height)
                                                       : ViewCamera::driver(40, width, height);
      std::size_t count = 0;
      const Picture picture = snapshot().render(view, camera);
      const double scale = static_cast<double>(picture.width) / camera.width;
      const Vector2 seen = redMiddle(picture, count) / scale;
      ASSERT_GT(count, 10U);
      const Vector2 expected = *camera.project(place + Vector3(0, 0, 0.25));
      EXPECT_NEAR(seen.x(), expected.x(), 1);
      EXPECT_NEAR(seen.y(), expected.y(), 1);
    }
  }
}

TEST(Snapshot, IsNotBlankAndHasTheStatedSize) {
  SceneView view = emptyView();
  view.scene.objects = {objectAt(1, 1, 100, 70), objectAt(2, 0, 95, 60)};
  const Picture picture = snapshot().picture(view);
  EXPECT_EQ(picture.height, 720);
  EXPECT_GT(picture.width, 2 * 1000);
  EXPECT_EQ(picture.rgb.size(), static_cast<std::size_t>(picture.width * picture.height) * 3);
  EXPECT_GT(colorsOf(picture), 100U);
  EXPECT_EQ(snapshot().labelsLeftOut(), 0);
}

TEST(Snapshot, EverySymbolChangesThePicture) {
  SceneView view = emptyView();
  view.scene.objects = {objectAt(1, 1, 100, 70)};
  Picture before = snapshot().picture(view);
  const auto changes = [&](const char* what) {
    Picture now = snapshot().picture(view);
    EXPECT_GT(difference(before, now), 1e-5) << what;
    before = std::move(now);
  };
  view.scene.objects[0].velocity = Vector2(0, 8);
  changes("speed arrow");
  view.trails[1] = {Vector3(100, 60, 0), Vector3(100, 70, 0)};
  changes("trail");
  view.scene.objects[0].existence = 0.6;
  changes("existence");
  view.scene.objects[0].classified = true;
  changes("label");
  for (int i = 0; i < 200; ++i) view.points.push_back({{95, 60 + 0.05 * i, 1}, 1.0F, 1.0F});
  changes("returns");
  view.occupied = {{{104, 65, 1}, Vector3::Constant(0.2), 3}};
  changes("occupied cell");
  view.corridor = Corridor{};
  view.free.distance = 20, view.free.blocked = true, view.free.seen = 15;
  changes("free lane");
  TruthObject truth;
  truth.position = Vector3(101, 70, 0);
  truth.length = 4;
  truth.width = 2;
  truth.height = 1.5;
  view.truth = {truth};
  changes("truth");
  view.points[0].trust = 0;
  for (ViewPoint& point : view.points) point.trust = 0;
  changes("distrusted returns");
  view.radar = {{{103, 66, 0.5}, Vector2(0, 5), true}};
  changes("radar return");
  view.radar[0].has_rate = false;
  changes("Doppler arrow");
  view.measurements = {{Modality::kRadar, {96, 68, 0}, {}}};
  changes("measurement");
  view.measurements[0].outline = {{95, 68, 0}, {97, 68, 0}, {97, 71, 0}};
  changes("outline of a measurement");
}

CameraModel pinhole() { return {1000, 500, 700, 700, 480, 240}; }

// Looking ahead from 1.5 m above the ego origin.
Pose3 cameraPose() {
  Pose3 pose = makePose(0, 0, 1.5, 0);
  pose.linear().col(0) = Vector3(0, -1, 0);
  pose.linear().col(1) = Vector3(0, 0, -1);
  pose.linear().col(2) = Vector3(1, 0, 0);
  return pose;
}

TEST(ViewCamera, ImageOfAPinholeIsThatOfItsModel) {
  const ViewCamera camera = ViewCamera::image(pinhole(), cameraPose(), 0.5);
  const Vector2 at = *camera.project({10, 2, 0.5});  // 2 m left, 1 m below the camera
  EXPECT_NEAR(at.x(), 0.5 * (480 - 700 * 0.2), 1e-9);
  EXPECT_NEAR(at.y(), 0.5 * (240 + 700 * 0.1), 1e-9);
  EXPECT_FALSE(camera.project({-10, 0, 0}));
}

TEST(ViewCamera, PanoramaSeesAllRoundAndPartsLinesAtItsSeam) {
  CameraModel model{2000, 1000, 2000 / kTwoPi, 2000 / kTwoPi, 1000, 500};
  model.projection = CameraModel::Projection::kEquirectangular;
  const ViewCamera camera = ViewCamera::image(model, cameraPose(), 1);
  EXPECT_NEAR(camera.project({0, 5, 1.5})->x(), 500, 1e-9) << "left: a quarter turn";
  EXPECT_NEAR(camera.project({0, -5, 1.5})->x(), 1500, 1e-9);
  EXPECT_NEAR(camera.project({5, 0, 1.5 - 5})->y(), 500 + 2000 / kTwoPi * kPi / 4, 1e-9);
  // Across the rear: no piece runs through the middle of the picture.
  double total = 0;
  for (const auto& [a, b] : camera.projectLine({-5, 1, 1.5}, {-5, -1, 1.5})) {
    EXPECT_GT(std::abs(a.x() - 1000), 900);
    EXPECT_LT((b - a).norm(), 40);
    total += (b - a).norm();
  }
  EXPECT_NEAR(total, 2000 / kTwoPi * 2 * std::atan(0.2), 40);
}

/// Boxes lie over the image at the place that the camera gives.
TEST(Snapshot, CameraViewLaysBoxesOverTheImage) {
  snapshot().setViews({ViewKind::kCamera});
  SceneView view = emptyView();
  ViewImage image;
  image.sensor = "CAMERA";
  image.camera = pinhole();
  image.T_world_camera = view.scene.ego.T_world_ego * cameraPose();
  image.picture = {1000, 500, std::vector<std::uint8_t>(1000 * 500 * 3, 40)};
  view.image = image;
  view.layers.camera = image.camera;
  const Picture bare = snapshot().picture(view);
  view.scene.objects = {objectAt(1, 1, 100, 70)};
  view.image->boxes = {{{400, 200, 560, 320}, "Car"}};
  const Picture drawn = snapshot().picture(view);
  snapshot().setViews({ViewKind::kTop, ViewKind::kDriver});
  ASSERT_EQ(bare.rgb.size(), drawn.rgb.size());
  EXPECT_GT(difference(bare, drawn), 1e-3);
  EXPECT_EQ(bare.at(100, 200)[0], 40) << "the image itself";
}

TEST(Snapshot, TwoRunsAreWiderThanOneAndOfOneSizeForAllInstants) {
  snapshot().setViews({ViewKind::kTop});
  SceneView a = emptyView(), b = emptyView();
  b.run_name = "other";
  const Picture two = snapshot().picture(std::vector<SceneView>{a, b});
  const Picture one = snapshot().picture(a);
  a.scene.objects = {objectAt(1, 1, 100, 70)};
  const Picture later = snapshot().picture(std::vector<SceneView>{a, b});
  snapshot().setViews({ViewKind::kTop, ViewKind::kDriver});
  EXPECT_GT(two.width, one.width + 900);
  EXPECT_EQ(two.width, later.width);
  EXPECT_EQ(two.height, later.height);
  EXPECT_EQ(two.width % 2, 0) << "for video codecs";
  EXPECT_EQ(two.height % 2, 0);
}

TEST(SceneFile, IsReadByMrpt) {
  SceneView view = emptyView();
  view.scene.objects = {objectAt(5, 1, 100, 70)};
  view.scene.objects[0].velocity = Vector2(0, 8);
  view.trails[5] = {Vector3(100, 60, 0), Vector3(100, 70, 0)};
  const std::string path = testing::TempDir() + "view.3Dscene";
  writeSceneFile(path, view, 40);
  mrpt::opengl::COpenGLScene scene;
  ASSERT_TRUE(scene.loadFromFile(path));
  for (const char* name : {"label 5", "velocity 5", "path 5", "truth", "measurements"}) {
    EXPECT_TRUE(scene.getByName(name)) << name;
  }
  std::filesystem::remove(path);
  EXPECT_THROW(writeSceneFile("/nonexistent/view.3Dscene", view, 40), OutputError);
}

TEST(Snapshot, SameViewGivesTheSameBytes) {
  SceneView view = emptyView();
  view.scene.objects = {objectAt(1, 1, 100, 70), objectAt(2, 0, 95, 60)};
  const Picture first = snapshot().picture(view);
  snapshot().tile(emptyView());
  EXPECT_EQ(first.rgb, snapshot().picture(view).rgb);
}

TEST(Snapshot, ObjectsAtAbsurdPlacesDoNoHarm) {
  SceneView view = emptyView();
  view.scene.objects = {objectAt(1, 1, 1e7, -1e7), objectAt(2, 0, 100, 40),
                        objectAt(3, 1, 100, 50)};
  view.scene.objects[1].velocity = Vector2(1e4, 0);
  EXPECT_GT(colorsOf(snapshot().picture(view)), 100U);
}

TEST(ContactSheet, HoldsEveryTile) {
  std::vector<Picture> tiles;
  for (int i = 0; i < 5; ++i) {
    SceneView view = emptyView();
    view.t = i;
    tiles.push_back(snapshot().tile(view));
  }
  const Picture sheet = contactSheet(tiles, emptyView());
  std::size_t area = 0;
  for (const Picture& tile : tiles) area += tile.rgb.size();
  EXPECT_GT(sheet.rgb.size(), area);
  EXPECT_GT(colorsOf(sheet), 20U);
  EXPECT_GT(colorsOf(contactSheet({}, emptyView())), 1U) << "a legend alone";
}

TEST(Trails, HoldTheLastSecondsOfTheSceneShown) {
  std::vector<Scene> scenes(50);
  for (int i = 0; i < 50; ++i) {
    scenes[static_cast<std::size_t>(i)].stamp = Stamp::fromSeconds(1000 + 0.1 * i);
    if (i >= 25) scenes[static_cast<std::size_t>(i)].objects = {objectAt(4, 1, i, 0)};
  }
  EXPECT_EQ(trailsUpTo(scenes, 30, 2).at(4).size(), 6U) << "scenes 25 to 30";
  const auto trail = trailsUpTo(scenes, 49, 2).at(4);
  EXPECT_EQ(trail.size(), 21U);
  EXPECT_DOUBLE_EQ(trail.back().x(), 49);
  EXPECT_TRUE(trailsUpTo(scenes, 10, 2).empty());
}

TEST(Picture, UnwritablePathIsAnOutputError) {
  EXPECT_THROW(writePicture("/nonexistent/folder/x.png", snapshot().tile(emptyView())),
               OutputError);
}

TEST(Renderer, ASecondOneIsRefused) {
  snapshot();
  EXPECT_THROW(Renderer(64, 64), std::logic_error);
}

/// In a process of its own, since EGL is loaded once.
TEST(RendererDeathTest, WithoutOpenGlSaysWhichPackageIsMissing) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        setenv("LIBGL_DRIVERS_PATH", "/nonexistent", 1);
        setenv("__EGL_VENDOR_LIBRARY_DIRS", "/nonexistent", 1);
        try {
          Renderer renderer(64, 64);
        } catch (const Error& error) {
          std::fputs(error.what(), stderr);
          std::exit(static_cast<int>(error.code()));
        }
        std::exit(0);
      },
      testing::ExitedWithCode(69), "libgl1-mesa-dri");
}

}  // namespace
}  // namespace perception
