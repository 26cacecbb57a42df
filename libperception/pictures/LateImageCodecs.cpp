// A library under the name of OpenCV's imgcodecs that loads OpenCV's own when the first picture is
// read or written. That one brings a hundred others (GDAL, DICOM, OpenEXR), MRPT links it, and most
// programs meet no picture. Programs find this one first (perception_program in
// cmake/Perception.cmake); where it is missing they find OpenCV's.
#include <dlfcn.h>

#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace perception {
namespace {

[[noreturn]] void failLoading(const std::string& what) {
  const char* reason = ::dlerror();
  throw std::runtime_error("pictures cannot be read or written: " + what + ": " +
                           (reason != nullptr ? reason : "not found"));
}

void* imageCodecs() {
  static void* const library = [] {
    // By its path: its name is taken. Global, as if the program had been linked with it.
    void* const opened = ::dlopen(PERCEPTION_IMAGE_CODECS, RTLD_NOW | RTLD_GLOBAL);
    if (opened == nullptr) failLoading(PERCEPTION_IMAGE_CODECS);
    return opened;
  }();
  return library;
}

/// OpenCV's function of the name and the type of ours.
template <typename Function>
Function* theirs(Function* ours) {
  Dl_info symbol{};
  if (::dladdr(reinterpret_cast<void*>(ours), &symbol) == 0 || symbol.dli_sname == nullptr)
    failLoading("a function of imgcodecs");
  void* const found = ::dlsym(imageCodecs(), symbol.dli_sname);
  if (found == nullptr) failLoading(symbol.dli_sname);
  return reinterpret_cast<Function*>(found);
}

}  // namespace
}  // namespace perception

// What version 4.6 exports: MRPT and OpenCV's other libraries need no more
// (cmake/ImageCodecsCheck.cmake).
namespace cv {

using perception::theirs;
using Numbers = std::vector<int>;

Mat imread(const String& file, int flags) {
  return theirs<Mat(const String&, int)>(&imread)(file, flags);
}
bool imreadmulti(const String& file, std::vector<Mat>& images, int flags) {
  return theirs<bool(const String&, std::vector<Mat>&, int)>(&imreadmulti)(file, images, flags);
}
bool imreadmulti(const String& file, std::vector<Mat>& images, int start, int count, int flags) {
  return theirs<bool(const String&, std::vector<Mat>&, int, int, int)>(&imreadmulti)(
      file, images, start, count, flags);
}
std::size_t imcount(const String& file, int flags) {
  return theirs<std::size_t(const String&, int)>(&imcount)(file, flags);
}
bool imwrite(const String& file, InputArray image, const Numbers& params) {
  return theirs<bool(const String&, InputArray, const Numbers&)>(&imwrite)(file, image, params);
}
Mat imdecode(InputArray bytes, int flags) {
  return theirs<Mat(InputArray, int)>(&imdecode)(bytes, flags);
}
Mat imdecode(InputArray bytes, int flags, Mat* into) {
  return theirs<Mat(InputArray, int, Mat*)>(&imdecode)(bytes, flags, into);
}
bool imencode(const String& ending, InputArray image, std::vector<uchar>& bytes,
              const Numbers& params) {
  return theirs<bool(const String&, InputArray, std::vector<uchar>&, const Numbers&)>(&imencode)(
      ending, image, bytes, params);
}
bool haveImageReader(const String& file) {
  return theirs<bool(const String&)>(&haveImageReader)(file);
}
bool haveImageWriter(const String& file) {
  return theirs<bool(const String&)>(&haveImageWriter)(file);
}

}  // namespace cv
