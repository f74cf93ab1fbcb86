#pragma once
/// \file
/// gnuplot as a separate program, where it is installed.

#include <filesystem>
#include <string>

namespace taut::bench {

/// Whether gnuplot can be run. The environment variable TAUT_GNUPLOT names another program, or none when
/// empty.
bool gnuplot_available();

/// Keeps `script` beside `image` (as image.gp) and runs it; `set output` is added here. False when gnuplot is
/// missing or fails, with its message in `why`; no image is left then.
bool run_gnuplot(const std::string& terminal, const std::string& script, const std::filesystem::path& image,
                 std::string& why);

/// A string in gnuplot's double quotes.
std::string quoted(const std::string& text);

}  // namespace taut::bench
