#pragma once
/// \file
/// The health of runs in report.html.

#include <lib/html.hpp>
#include <lib/report.hpp>

namespace taut::bench {

/// A table, runs by measures, green to red: of each measure the worst of a run's cases; below it one line of
/// meaning each.
void write_health(HtmlPage& page, const SceneReport& part);

}  // namespace taut::bench
