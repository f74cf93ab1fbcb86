#pragma once
/// \file
/// Where in a scene file something stands.

#include <lib/terminal.hpp>
#include <memory>
#include <string>
#include <taut/base/error.hpp>

namespace taut::bench {

/// A position in a file; prints as "file:line:column".
struct Place {
  std::shared_ptr<const std::string> file;
  unsigned line = 0, column = 0;

  std::string str() const {
    return (file ? visible(*file) : std::string("scene")) + ':' + std::to_string(line) + ':' +
           std::to_string(column);
  }
};

/// \throws InputError "file:line:column: what", made visible: `what()` would end at a NUL.
[[noreturn]] inline void fail(const Place& place, const std::string& what) {
  throw InputError(place.str() + ": " + visible(what));
}

}  // namespace taut::bench
