# Debian's packages first; TAUT_FETCH=ON downloads what is missing elsewhere.
include(FetchContent)

# The oldest compilers that are tested.
foreach(known "GNU 12" "Clang 14")
  string(REPLACE " " ";" known ${known})
  list(GET known 0 compiler)
  list(GET known 1 oldest)
  if(CMAKE_CXX_COMPILER_ID STREQUAL compiler AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS oldest)
    message(FATAL_ERROR "taut needs g++ 12 or clang++ 14, or later; ${CMAKE_CXX_COMPILER} is ${CMAKE_CXX_COMPILER_VERSION}.")
  endif()
endforeach()

# `version`: the oldest that is tested, and the one that is downloaded.
function(taut_require package version target url sha256)
  find_package(${package} ${version} QUIET)
  if(TARGET ${target})
    return()
  endif()
  if(NOT TAUT_FETCH)
    set(seen)
    if(${package}_CONSIDERED_VERSIONS)
      list(REMOVE_DUPLICATES ${package}_CONSIDERED_VERSIONS)
      set(seen " (there is ${${package}_CONSIDERED_VERSIONS})")
    endif()
    message(FATAL_ERROR "taut needs ${package} ${version} or later${seen}. Install its package "
                        "(see README.md, 'Two commands') or configure with -DTAUT_FETCH=ON to download it.")
  endif()
  FetchContent_Declare(${package} URL ${url} URL_HASH SHA256=${sha256} DOWNLOAD_EXTRACT_TIMESTAMP OFF)
  FetchContent_MakeAvailable(${package})
endfunction()

find_package(OpenMP REQUIRED COMPONENTS CXX)
taut_require(Eigen3 3.4.0 Eigen3::Eigen https://gitlab.com/libeigen/eigen/-/archive/3.4.0/eigen-3.4.0.tar.gz
             8586084f71f9bde545ee7fa6d00288b264a2b7ac3607b974e54d13e7162c1c72)
taut_require(fmt 9.1.0 fmt::fmt https://github.com/fmtlib/fmt/archive/refs/tags/9.1.0.tar.gz
             5dea48d1fcddc3ec571ce2058e13910a0d4a6bab4cc09a809d8b1dd1c88ae6f2)
set(NANOFLANN_BUILD_EXAMPLES OFF CACHE INTERNAL "")
set(NANOFLANN_BUILD_TESTS OFF CACHE INTERNAL "")
taut_require(nanoflann 1.4 nanoflann::nanoflann
             https://github.com/jlblancoc/nanoflann/archive/refs/tags/v1.4.3.tar.gz
             cbcecf22bec528a8673a113ee9b0e134f91f1f96be57e913fa1f74e98e4449fa)
if(TAUT_HDF5)
  enable_language(C) # FindHDF5 asks the C compiler
  find_package(HDF5 1.10 QUIET COMPONENTS C)
  if(NOT HDF5_FOUND)
    message(STATUS "taut: HDF5 (1.10 or later) not found, so field output (.vtkhdf) is left out")
  endif()
endif()
if(TAUT_QHULL)
  # By path, not by Qhull's own target: users of the installed package need not find it again.
  find_path(QHULL_INCLUDE_DIR libqhull_r/qhull_ra.h)
  find_library(QHULL_LIBRARY qhull_r)
  mark_as_advanced(QHULL_INCLUDE_DIR QHULL_LIBRARY)
  if(NOT QHULL_INCLUDE_DIR OR NOT QHULL_LIBRARY)
    message(STATUS "taut: Qhull not found, so clouds from files must bring their volumes and boundary")
  endif()
endif()
if(TAUT_BENCH)
  taut_require(CLI11 2.1.2 CLI11::CLI11 https://github.com/CLIUtils/CLI11/archive/refs/tags/v2.1.2.tar.gz
               26291377e892ba0e5b4972cdfd4a2ab3bf53af8dac1f4ea8fe0d1376b625c8cb)
  taut_require(tomlplusplus 3.3.0 tomlplusplus::tomlplusplus
               https://github.com/marzer/tomlplusplus/archive/refs/tags/v3.3.0.tar.gz
               fc1a5eb410f3c67e90e5ad1264a1386d020067cfb01b633cc8c0441789aa6cf2)
endif()
if(TAUT_TESTS)
  taut_require(doctest 2.4.9 doctest::doctest https://github.com/doctest/doctest/archive/refs/tags/v2.4.9.tar.gz
               19b2df757f2f3703a5e63cee553d85596875f06d91a3333acd80a969ef210856)
endif()
