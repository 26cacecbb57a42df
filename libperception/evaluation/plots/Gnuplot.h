#pragma once
#include <string>

namespace perception {

/// Runs `gnuplot SCRIPT` (Debian: gnuplot-nox) inside `dir`, C locale, its messages in
/// DIR/gnuplot.log. Returns a one-line error message ("gnuplot is not installed ..."), empty on
/// success.
std::string runGnuplot(const std::string& dir, const std::string& script);

/// The text as a quoted gnuplot string; control characters become spaces.
std::string gnuplotString(const std::string& text);

}  // namespace perception
