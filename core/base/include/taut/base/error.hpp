#pragma once
/// \file
/// The one family of errors.

#include <stdexcept>
#include <string>
#include <vector>

namespace taut {

/// Base of every error that taut throws: what was wrong, where, and what would be right.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The caller's input cannot be used: a bad parameter, name, file or point cloud.
class InputError : public Error {
 public:
  using Error::Error;
};

/// A run cannot go on for a reason outside the numerics, such as a file that cannot be written.
class RunError : public Error {
 public:
  using Error::Error;
};

/// Names for an error message: "a, b, c".
std::string join_names(const std::vector<std::string>& names);

}  // namespace taut
