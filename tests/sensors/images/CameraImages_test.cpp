#include "libperception/sensors/images/CameraImages.h"

#include <gtest/gtest.h>

#include "libperception/sensors/frames/FromObservation.h"
#include "libperception/sensors/frames/ToObservation.h"
#include "libperception/sensors/observations/Conversions.h"
#include "tests/sensors/TestFiles.h"

namespace perception {
namespace {

using namespace perception::testing;

mrpt::obs::CObservationImage imageObservation() {
  mrpt::obs::CObservationImage o;
  o.timestamp = fromStamp(kStart);
  o.sensorLabel = "CAMERA_LEFT";
  o.cameraPose = mrpt::poses::CPose3D(0.3, 0, 1.6, -kPi / 2, 0, -kPi / 2);
  o.cameraParams.ncols = 8, o.cameraParams.nrows = 4;
  o.cameraParams.setIntrinsicParamsFromValues(7, 7.5, 4, 2);
  return o;
}

TEST(CameraImages, PixelsInTheLogAreRowsOfBlueGreenRed) {
  auto o = imageObservation();
  o.image = mrpt::img::CImage(8, 4, mrpt::img::CH_RGB);
  o.image.filledRectangle(0, 0, 7, 3, mrpt::img::TColor(10, 20, 30));
  o.image.setPixel(5, 2, mrpt::img::TColor(200, 100, 50));
  const auto frame = frameFromObservation(o);
  ASSERT_TRUE(frame);
  EXPECT_TRUE(isImage(o));
  const auto& image = std::get<CameraImage>(frame->data);
  EXPECT_EQ(image.camera.width, 8);
  EXPECT_EQ(image.camera.fy, 7.5);
  const auto raster = image.load();
  ASSERT_TRUE(raster);
  ASSERT_EQ(raster->pixels.size(), 8U * 4 * 3);
  const std::size_t at = (2 * 8 + 5) * 3;
  EXPECT_EQ(raster->pixels[at], 50);       // blue
  EXPECT_EQ(raster->pixels[at + 1], 100);  // green
  EXPECT_EQ(raster->pixels[at + 2], 200);  // red
}

TEST(CameraImages, FilesBesideTheLogAreReadWhenAskedForAndMissingOnesAreCounted) {
  const TemporaryFolder folder;
  const std::string log = folder / "drive.rawlog", images = imagesBeside(log);
  EXPECT_EQ(images, folder / "drive_Images");
  std::filesystem::create_directory(images);
  mrpt::img::CImage pixels(8, 4, mrpt::img::CH_RGB);
  pixels.filledRectangle(0, 0, 7, 3, mrpt::img::TColor(1, 2, 3));
  ASSERT_TRUE(pixels.saveToFile(images + "/there.png"));
  writeBytes(images + "/text.png", "no image");

  auto o = imageObservation();
  DecodeCounts counts;
  o.image.setExternalStorage("there.png");
  const auto there = frameFromObservation(o, &counts, images);
  ASSERT_TRUE(there);
  EXPECT_EQ(counts.missing_images, 0U);
  const auto raster = std::get<CameraImage>(there->data).load();
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->pixels[0], 3);

  o.image.setExternalStorage("text.png");
  const auto text = frameFromObservation(o, &counts, images);
  ASSERT_TRUE(text);
  EXPECT_FALSE(std::get<CameraImage>(text->data).load());

  o.image.setExternalStorage("gone.png");
  const auto gone = frameFromObservation(o, &counts, images);
  ASSERT_TRUE(gone);
  EXPECT_EQ(counts.missing_images, 1U);
  EXPECT_FALSE(std::get<CameraImage>(gone->data).load());
  EXPECT_EQ(std::get<CameraImage>(gone->data).source, images + "/gone.png");

  mrpt::obs::CObservationImage empty = imageObservation();
  ASSERT_TRUE(frameFromObservation(empty, &counts));
  EXPECT_EQ(counts.missing_images, 2U);
  EXPECT_FALSE(std::get<CameraImage>(frameFromObservation(empty)->data).load());
}

/// 64 x 32 pixels of one color.
CameraImage imageOf(const CameraModel& camera) {
  CameraImage image;
  image.camera = camera;
  image.load = [camera] {
    Raster raster{camera.width, camera.height, 3, {}};
    for (int i = 0; i < camera.width * camera.height; ++i)
      raster.pixels.insert(raster.pixels.end(), {10, 20, 30});
    return std::optional<Raster>(raster);
  };
  return image;
}

TEST(CameraImages, ImagesGoIntoALogAndComeBack) {
  SensorFrame frame;
  frame.sensor = "FRONT";
  frame.stamp = kStart;
  CameraModel pinhole;
  pinhole.width = 64, pinhole.height = 32;
  pinhole.fx = 50, pinhole.fy = 51, pinhole.cx = 31.5, pinhole.cy = 15.5;
  frame.data = imageOf(pinhole);
  const auto back = frameFromObservation(*observationFromFrame(frame));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->sensor, "FRONT");
  const auto& image = std::get<CameraImage>(back->data);
  EXPECT_EQ(image.camera.fy, 51);
  EXPECT_EQ(image.camera.cx, 31.5);
  const auto raster = image.load();
  ASSERT_TRUE(raster);
  EXPECT_EQ(raster->pixels.size(), 64U * 32 * 3);
  EXPECT_EQ(raster->pixels[2], 30);
}

TEST(CameraImages, PanoramasComeWithoutCalibrationAndAreKnownByTheirShape) {
  const auto panorama = panoramaModel(1536, 768);
  ASSERT_TRUE(panorama);
  EXPECT_EQ(panorama->projection, CameraModel::Projection::kEquirectangular);
  EXPECT_EQ(panorama->cx, 767.5);
  SensorFrame frame;
  frame.stamp = kStart;
  frame.data = imageOf(*panorama);
  const auto back = frameFromObservation(*observationFromFrame(frame));
  ASSERT_TRUE(back);
  const CameraModel& read = std::get<CameraImage>(back->data).camera;
  EXPECT_EQ(read.fx, 0);
  EXPECT_TRUE(panoramaModel(read.width, read.height));
  EXPECT_FALSE(panoramaModel(1242, 375));
  EXPECT_FALSE(panoramaModel(512, 256)) << "smaller than any panorama";
}

}  // namespace
}  // namespace perception
