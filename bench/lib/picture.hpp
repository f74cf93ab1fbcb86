#pragma once
/// \file
/// Pictures of deformed bodies coloured by stress.

#include <filesystem>
#include <lib/case.hpp>
#include <vector>

namespace taut::bench {

/// Whether a run is among those that a picture shows.
bool shows(const PictureSpec& picture, const RunSpec& run);
/// Cases that go into a picture: for each run the one whose swept values come nearest to the wanted ones.
/// Indices into `points`.
std::size_t nearest_point(const std::vector<SweepPoint>& points, const SweepPoint& wanted);

/// One panel a case (24 at the most), all at the same scale and with the same colours, the undeformed outline
/// dashed: a PNG. Bodies of three dimensions are seen as `PictureSpec::from` says, lit from above.
/// False without gnuplot.
bool write_picture(const PictureSpec& picture, const std::vector<const CaseResult*>& cases,
                   const std::filesystem::path& image, std::string& why);

}  // namespace taut::bench
