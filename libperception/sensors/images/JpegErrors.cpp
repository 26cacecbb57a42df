#include "libperception/sensors/images/JpegErrors.h"

#include <dlfcn.h>

#include <cstdio>
// After stdio: jpeglib.h needs FILE.
#include <jpeglib.h>

#include <array>
#include <stdexcept>

namespace {

[[noreturn]] void throwError(j_common_ptr jpeg) {
  std::array<char, JMSG_LENGTH_MAX> text{};
  jpeg->err->format_message(jpeg, text.data());
  throw std::runtime_error(std::string("JPEG image: ") + text.data());
}

}  // namespace

// MRPT decodes images with libjpeg's default errors, which end the process. This definition
// overrides that of the library in every program that links RawlogReader.
extern "C" jpeg_error_mgr* jpeg_std_error(jpeg_error_mgr* errors) {
  using Original = jpeg_error_mgr* (*)(jpeg_error_mgr*);
  static const auto original = reinterpret_cast<Original>(::dlsym(RTLD_NEXT, "jpeg_std_error"));
  original(errors);
  errors->error_exit = [](j_common_ptr jpeg) { throwError(jpeg); };
  return errors;
}

namespace perception {

void linkJpegErrors() {}

}  // namespace perception
