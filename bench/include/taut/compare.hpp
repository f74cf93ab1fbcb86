#pragma once
/// \file
/// taut-compare as a function, for programs that add materials, kernels, operators or formulations of their
/// own to the registries before they call it. CMake: link `taut::compare`.

namespace taut {

/// What the program `taut-compare` does with these arguments: scenes, options, `--list KIND`. Messages go to
/// standard error. \returns the exit code: 0 done, 1 a run failed, 2 bad input, 128 + signal where one asked
/// for the end.
int compare_main(int argc, char** argv);

}  // namespace taut
