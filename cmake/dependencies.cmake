# Debian's packages first; TAUT_FETCH=ON downloads what is missing elsewhere.
include(FetchContent)

function(taut_require package target url)
  find_package(${package} QUIET)
  if(TARGET ${target})
    return()
  endif()
  if(NOT TAUT_FETCH)
    message(FATAL_ERROR "taut needs ${package}. Install its package (see README.md, 'Two commands') "
                        "or configure with -DTAUT_FETCH=ON to download it.")
  endif()
  FetchContent_Declare(${package} URL ${url})
  FetchContent_MakeAvailable(${package})
endfunction()

find_package(OpenMP REQUIRED COMPONENTS CXX)
taut_require(Eigen3 Eigen3::Eigen https://gitlab.com/libeigen/eigen/-/archive/3.4.0/eigen-3.4.0.tar.gz)
taut_require(fmt fmt::fmt https://github.com/fmtlib/fmt/archive/refs/tags/9.1.0.tar.gz)
taut_require(nanoflann nanoflann::nanoflann
             https://github.com/jlblancoc/nanoflann/archive/refs/tags/v1.4.3.tar.gz)
if(TAUT_HDF5)
  enable_language(C) # FindHDF5 asks the C compiler
  find_package(HDF5 QUIET COMPONENTS C)
  if(NOT HDF5_FOUND)
    message(STATUS "taut: HDF5 not found, so field output (.vtkhdf) is left out")
  endif()
endif()
if(TAUT_BENCH)
  taut_require(CLI11 CLI11::CLI11 https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.1.2.tar.gz)
  taut_require(tomlplusplus tomlplusplus::tomlplusplus
               https://github.com/marzer/tomlplusplus/archive/refs/tags/v3.3.0.tar.gz)
endif()
if(TAUT_TESTS)
  taut_require(doctest doctest::doctest https://github.com/doctest/doctest/archive/refs/tags/v2.4.9.tar.gz)
endif()
