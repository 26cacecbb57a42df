#pragma once
#include <string>

namespace perception {

/// Runs `gnuplot SCRIPT` (Debian: gnuplot-nox) inside `dir`, C locale, its messages in
/// DIR/gnuplot.log. Returns what went wrong in one line ("gnuplot is not installed ..."), or
/// nothing.
std::string runGnuplot(const std::string& dir, const std::string& script);

/// The text as a gnuplot string; what a line cannot hold becomes a space.
std::string gnuplotString(const std::string& text);

}  // namespace perception
