#pragma once
// What is refused, and the message.

#include <doctest/doctest.h>

#include <string>
#include <taut/base/error.hpp>

namespace taut::test {

/// The message of the InputError that f throws; empty when it throws none.
template <class F>
std::string refusal(F&& f) {
  try {
    f();
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

}  // namespace taut::test

/// The statement throws an InputError whose message has all the parts in it.
#define CHECK_REFUSED(statement, ...)                                    \
  do {                                                                   \
    const std::string message = taut::test::refusal([&] { statement; }); \
    CAPTURE(message);                                                    \
    for (const char* part : {__VA_ARGS__}) {                             \
      CAPTURE(part);                                                     \
      CHECK(message.find(part) != std::string::npos);                    \
    }                                                                    \
  } while (false)
