#include "gui-offscreen/html/ReviewPage.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "gui-offscreen/html/HtmlText.h"
#include "gui-offscreen/html/ReportStyle.h"

namespace perception {
namespace {

constexpr int kQuality = 85;  // of JPEG

constexpr const char* kStyle = R"css(
body { max-width: 1310px; }
#pictures { display: flex; flex-wrap: wrap; gap: 8px; margin: 12px 0; min-height: 200px; }
#pictures img { border: 1px solid #ccc; max-width: 100%; }
#question { font-size: 24px; margin: 8px 0; }
button { font: inherit; font-size: 18px; padding: 8px 18px; margin: 0 8px 8px 0; cursor: pointer; }
button.chosen { outline: 3px solid #0a5ac8; }
progress { width: 100%; height: 14px; }
.muted { color: #555; }
)css";

constexpr const char* kScript = R"js(
const data = JSON.parse(document.getElementById('data').textContent);
const key = 'perception review ' + data.name;
const answers = JSON.parse(localStorage.getItem(key) || '{}');
const $ = id => document.getElementById(id);
let at = data.questions.findIndex(q => !(q.row in answers));
if (at < 0) at = 0;
function show() {
  const q = data.questions[at];
  $('question').textContent = 'Is this a ' + q.class + '?';
  $('pictures').replaceChildren(...q.pictures.map(p => Object.assign(new Image(), {src: 'data:image/jpeg;base64,' + p})));
  $('facts').textContent = (at + 1) + ' of ' + data.questions.length + ': object ' + q.id + ', t = ' + q.t + ' s';
  const done = data.questions.filter(q => q.row in answers).length;
  $('progress').value = done;
  $('left').textContent = (data.questions.length - done) + ' not answered yet';
  for (const b of document.querySelectorAll('button[data-answer]'))
    b.classList.toggle('chosen', answers[q.row] === b.dataset.answer);
}
function answer(text) {
  answers[data.questions[at].row] = text;
  try { localStorage.setItem(key, JSON.stringify(answers)); } catch (e) { $('left').textContent = e; }
  step(1);
}
function step(by) { at = Math.min(Math.max(at + by, 0), data.questions.length - 1); show(); }
function csv() {
  return data.header + data.questions.map(q => q.row + ',' + (answers[q.row] || '') + '\n').join('');
}
function save() {
  const link = document.createElement('a');
  link.href = URL.createObjectURL(new Blob([csv()], {type: 'text/csv'}));
  link.download = 'answers.csv';
  link.click();
}
for (const b of document.querySelectorAll('button[data-answer]')) b.onclick = () => answer(b.dataset.answer);
$('back').onclick = () => step(-1);
$('next').onclick = () => step(1);
$('save').onclick = save;
document.onkeydown = e => {
  const done = {y: () => answer('yes'), n: () => answer('no'), u: () => answer('unsure'), s: save,
                ArrowLeft: () => step(-1), ArrowRight: () => step(1)}[e.key];
  if (done && !e.ctrlKey && !e.metaKey) { done(); e.preventDefault(); }
};
show();
)js";

}  // namespace

std::string reviewPage(const std::string& title, const std::string& header,
                       const std::vector<ReviewQuestion>& questions) {
  nlohmann::ordered_json data;
  data["name"] = title;
  data["header"] = header;
  data["questions"] = nlohmann::ordered_json::array();
  for (const ReviewQuestion& q : questions) {
    nlohmann::ordered_json pictures = nlohmann::ordered_json::array();
    for (const Picture& picture : q.pictures)
      pictures.push_back(base64(jpegOf(picture, picture.width, kQuality)));
    data["questions"].push_back({{"t", fmt::format("{:.2f}", q.t)},
                                 {"id", q.id},
                                 {"class", q.class_name},
                                 {"row", q.row},
                                 {"pictures", pictures}});
  }
  std::string text = data.dump();
  // Text of an element ends at "</".
  for (auto i = text.find("</"); i != std::string::npos; i = text.find("</", i + 3))
    text.replace(i, 2, "<\\/");
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}{2}</style>\n</head>\n<body>\n<h1>{0}</h1>\n"
      "<p class=\"muted\">What is outlined in blue: in the camera's image where there is one, as "
      "the "
      "lidar sees it from the vehicle's roof, and from above (the vehicle drives up the picture). "
      "Keys: y, n, u, "
      "arrows, s. Answers stay in this browser until they are saved.</p>\n"
      "<progress id=\"progress\" max=\"{3}\"></progress>\n<div id=\"question\"></div>\n"
      "<div>\n"
      "<button data-answer=\"yes\">Yes (y)</button><button data-answer=\"no\">No (n)</button>"
      "<button data-answer=\"unsure\">Cannot tell (u)</button>"
      "<button id=\"back\">Back</button><button id=\"next\">Next</button>"
      "<button id=\"save\">Save answers.csv (s)</button>\n</div>\n"
      "<div id=\"pictures\"></div>\n"
      "<p><span id=\"facts\"></span>; <span id=\"left\"></span></p>\n"
      "<script type=\"application/json\" id=\"data\">{4}</script>\n<script>{5}</script>\n"
      "</body>\n</html>\n",
      escaped(title), kReportStyle, kStyle, questions.size(), text, kScript);
}

}  // namespace perception
