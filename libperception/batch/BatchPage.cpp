#include "libperception/batch/BatchPage.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "gui-offscreen/html/HtmlText.h"
#include "gui-offscreen/html/ReportStyle.h"
#include "libperception/batch/BatchScript.h"

namespace perception {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Figures by class, counts of truth lines and the like stand in the tables beside the page.
bool isOnPage(const std::string& figure) {
  return figure.find(".classes.") == std::string::npos &&
         figure.find(".confusion.") == std::string::npos && figure.rfind("coverage.", 0) != 0;
}

/// Where a click on a shard goes: its page if it has one, else its folder, else what it said.
std::string linkOf(const ShardResult& result, const std::string& dir) {
  const std::string& id = result.shard.id;
  if (!result.status.hasResult())
    return fs::exists(dir + "/log/" + id + ".log") ? "log/" + id + ".log" : "";
  return fs::exists(dir + "/" + id + "/index.html") ? id + "/index.html" : id + "/";
}

/// What the page's script reads: names of columns and figures, a row of both for each shard.
Json dataOf(const BatchResults& results, const std::string& dir) {
  Json data = {{"columns", Json::array()}, {"figures", Json::array()}, {"shards", Json::array()}};
  for (const ShardColumn& column : shardColumns()) data["columns"].push_back(column.name);
  std::vector<std::string> figures;
  std::copy_if(results.figures.begin(), results.figures.end(), std::back_inserter(figures),
               isOnPage);
  data["figures"] = figures;
  for (const ShardResult& result : results.shards) {
    Json cells = Json::array(), values = Json::array();
    for (const ShardColumn& column : shardColumns()) cells.push_back(column.text(result));
    for (const std::string& name : figures) {
      const double* value = result.figure(name);
      values.push_back(value ? Json(*value) : Json(nullptr));
    }
    data["shards"].push_back(
        {{"cells", cells}, {"figures", values}, {"link", linkOf(result, dir)}});
  }
  return data;
}

std::string tile(std::size_t count, const char* what) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", count, what);
}

/// Names of logs and reasons end neither the script nor a comment.
std::string insideScript(std::string json) {
  for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; at += 6)
    json.replace(at, 1, "\\u003c");
  return json;
}

}  // namespace

std::string batchPage(const Batch& batch, const BatchResults& results, const std::string& dir) {
  const std::string title = "Batch " + batch.config;
  std::string tiles = tile(results.shards.size(), "shards");
  for (int s = 0; s < kShardStates; ++s) {
    const auto count = std::count_if(
        results.shards.begin(), results.shards.end(),
        [&](const ShardResult& r) { return r.status.state == static_cast<ShardState>(s); });
    if (count > 0)
      tiles += tile(static_cast<std::size_t>(count), nameOf(static_cast<ShardState>(s)));
  }
  const auto simulated = std::count_if(
      results.shards.begin(), results.shards.end(),
      [](const ShardResult& r) { return r.status.record && r.status.record->simulated; });
  const auto evaluated = std::count_if(results.shards.begin(), results.shards.end(),
                                       [](const ShardResult& r) { return !r.figures.empty(); });
  std::string lead = fmt::format("{} of {} shards have figures against the truth of their log.",
                                 evaluated, results.shards.size());
  if (simulated > 0)
    lead += fmt::format(" {} are of <b>simulated</b> logs: their figures are simulated results.",
                        simulated);
  const std::string data =
      insideScript(dataOf(results, dir).dump(-1, ' ', false, Json::error_handler_t::replace));
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width\">\n<title>{}</title>\n"
      "<style>{}{}</style>\n</head>\n<body>\n<h1>{}</h1>\n<p class=\"lead\">{}</p>\n"
      "<div class=\"tiles\">\n{}</div>\n{}<p>The same in <a href=\"shards.csv\">shards.csv</a> and "
      "<a href=\"batch.sqlite\">batch.sqlite</a>, figures by class too. perception-batch {}.</p>\n"
      "<script id=\"data\" type=\"application/json\">{}</script>\n<script>{}</script>\n"
      "</body>\n</html>\n",
      escaped(title), kReportStyle, kBatchStyle, escaped(title), lead, tiles, kBatchBody,
      escaped(batch.version), data, kBatchScript);
}

}  // namespace perception
