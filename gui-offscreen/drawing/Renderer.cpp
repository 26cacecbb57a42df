#include "gui-offscreen/drawing/Renderer.h"

#include <mrpt/opengl/CFBORender.h>
#include <mrpt/opengl/COpenGLScene.h>

#include <atomic>
#include <cstring>
#include <stdexcept>

#include "libperception/core/Error.h"
#include "libperception/core/MrptCompatibility.h"

namespace perception {
namespace {

std::atomic_flag renderer_alive = ATOMIC_FLAG_INIT;

mrpt::opengl::CCamera cameraOf(const ViewCamera& camera, int width, int height) {
  const double scale = static_cast<double>(width) / camera.width;
  mrpt::img::TCamera pinhole;
  pinhole.ncols = static_cast<std::uint32_t>(width);
  pinhole.nrows = static_cast<std::uint32_t>(height);
  pinhole.setIntrinsicParamsFromValues(camera.focal * scale, camera.focal_y * scale, width / 2.0,
                                       height / 2.0);
  mrpt::opengl::CCamera result;
  result.setProjectiveFromPinhole(pinhole);
  result.set6DOFMode(true);
  const Pose3& T = camera.T_ego_camera;
  result.setPose(mrpt::poses::CPose3D(mrpt::math::CMatrixDouble33(Eigen::Matrix3d(T.linear())),
                                      mrpt::math::CVectorFixedDouble<3>(Vector3(T.translation()))));
  return result;
}

Picture pictureOf(const mrpt::img::CImage& image) {
  Picture picture;
  picture.width = static_cast<int>(image.getWidth());
  picture.height = static_cast<int>(image.getHeight());
  const std::size_t row = static_cast<std::size_t>(picture.width) * 3;
  picture.rgb.resize(row * static_cast<std::size_t>(picture.height));
  const bool swapped = image.getChannelsOrder() == "BGR";
  for (int y = 0; y < picture.height; ++y) {
    std::uint8_t* to = &picture.rgb[row * static_cast<std::size_t>(y)];
    std::memcpy(to, image.ptrLine<std::uint8_t>(static_cast<unsigned>(y)), row);
    for (std::size_t x = 0; swapped && x < row; x += 3) std::swap(to[x], to[x + 2]);
  }
  return picture;
}

}  // namespace

struct Renderer::Impl {
  explicit Impl(int width, int height)
      : framebuffer(static_cast<unsigned>(width), static_cast<unsigned>(height)) {}
  mrpt::opengl::CFBORender framebuffer;
};

Renderer::Renderer(int width, int height) : width_(width), height_(height) {
  if (renderer_alive.test_and_set()) {
    throw std::logic_error("a second offscreen renderer in one process");
  }
  try {
    impl_ = std::make_unique<Impl>(width, height);
  } catch (const std::exception& error) {
    renderer_alive.clear();
    throw Error(ExitCode::kUnavailable,
                std::string("no OpenGL for pictures; on a machine without a graphics card install "
                            "the Debian package libgl1-mesa-dri (") +
                    std::string(error.what()).substr(0, std::string(error.what()).find('\n')) +
                    ")");
  }
}

Renderer::~Renderer() {
  impl_.reset();
  renderer_alive.clear();
}

Picture Renderer::render(const SceneView& view, const ViewCamera& camera) {
  const auto scene = openGlScene(view, camera);
  const auto viewport = scene->getViewport();
  viewport->setCustomBackgroundColor({1.0F, 1.0F, 1.0F});
  viewport->setViewportClipDistances(static_cast<float>(camera.near),
                                     static_cast<float>(camera.far));
  // Nearly flat shading, since colors have a meaning.
  auto& light = viewport->lightParameters();
  setLight(light.ambient, 0.85F);
  setLight(light.diffuse, 0.15F);
  setLight(light.specular, 0);
  impl_->framebuffer.setCamera(*scene, cameraOf(camera, width_, height_));
  mrpt::img::CImage image;
  impl_->framebuffer.render_RGB(*scene, image);
  return pictureOf(image);
}

}  // namespace perception
