#include "libperception/live/LivePage.h"

#include <fmt/format.h>

#include "gui-offscreen/html/HtmlText.h"
#include "gui-offscreen/html/PageBundle.h"
#include "gui-offscreen/html/ReportStyle.h"

namespace perception {

std::string livePage(const std::string& log) {
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}, live</title>\n<style>{1}{2}</style>\n</head>\n<body>\n"
      "<h1>What is around the vehicle: {0}</h1>\n<p id=\"live\" role=\"status\">connecting</p>\n"
      "<div id=\"viewer\" data-run=\"live\" data-live></div>\n<div id=\"weather\"></div>\n"
      "<div id=\"events\"></div>\n<script nonce=\"{{NONCE}}\">{3}</script>\n</body>\n</html>\n",
      escaped(log), kReportStyle, pageStyle(), pageScript());
}

}  // namespace perception
