#include "gui-offscreen/html/PageBundle.h"

// The assembler copies the files into the program: no source of half a megabyte to compile.
// PERCEPTION_PAGE_DIR comes from CMakeLists.txt.
asm(".section .rodata\n"
    ".global perception_page_script, perception_page_script_end\n"
    ".global perception_page_style, perception_page_style_end\n"
    "perception_page_script:\n"
    ".incbin \"" PERCEPTION_PAGE_DIR
    "/bundle/page.js\"\n"
    "perception_page_script_end:\n"
    "perception_page_style:\n"
    ".incbin \"" PERCEPTION_PAGE_DIR
    "/bundle/page.css\"\n"
    "perception_page_style_end:\n"
    ".byte 0\n"
    ".previous\n");

extern "C" {
extern const char perception_page_script[], perception_page_script_end[];
extern const char perception_page_style[], perception_page_style_end[];
}

namespace perception {

std::string_view pageScript() {
  return {perception_page_script,
          static_cast<std::size_t>(perception_page_script_end - perception_page_script)};
}

std::string_view pageStyle() {
  return {perception_page_style,
          static_cast<std::size_t>(perception_page_style_end - perception_page_style)};
}

}  // namespace perception
