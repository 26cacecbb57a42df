#pragma once
#include <sys/types.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/TemporaryFolder.h"

namespace perception::test {

/// A headless Chromium without network, steered over pipes by the DevTools protocol
/// (https://chromedevtools.github.io/devtools-protocol). Every fault throws std::runtime_error.
class Browser {
 public:
  /// Path of Debian's chromium, or of what the environment's CHROMIUM names; empty: it is not here.
  static std::string program();

  Browser();
  ~Browser();
  Browser(const Browser&) = delete;
  Browser& operator=(const Browser&) = delete;

  /// Size of the window [px]; narrow ones are phones.
  void resize(int width, int height);
  /// Opens a file; forgets faults and requests.
  void open(const std::string& file);
  /// Value of a JavaScript expression.
  nlohmann::json value(const std::string& expression);
  /// Until the expression is true, at most a minute.
  void waitFor(const std::string& expression);
  /// Coordinates in the window [px].
  void click(double x, double y) { drag(x, y, x, y); }
  void drag(double x0, double y0, double x1, double y1);
  void press(const std::string& key);
  /// The whole page as PNG.
  void screenshot(const std::string& path);

  const std::vector<std::string>& faults() const { return faults_; }      ///< of the page's scripts
  const std::vector<std::string>& requests() const { return requests_; }  ///< to a network

 private:
  nlohmann::json call(const std::string& method, nlohmann::json params = nlohmann::json::object());
  nlohmann::json next();
  void note(const nlohmann::json& event);

  TemporaryFolder profile_;
  pid_t process_ = -1;
  int to_ = -1, from_ = -1;
  int calls_ = 0, width_ = 0;
  std::string session_, unread_;
  std::vector<std::string> faults_, requests_;
};

}  // namespace perception::test
