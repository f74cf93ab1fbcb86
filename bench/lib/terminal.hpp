#pragma once
/// \file
/// What reaches a terminal. Text of scenes, tables, files and command lines is not ours: it may hold what
/// terminals obey.

#include <string>
#include <string_view>

namespace taut::bench {

/// UTF-8 text without what would act on a terminal or turn its order around: control characters other than
/// line breaks and tabs, marks of direction, invisible characters stand as `\u001b`, bytes that are no UTF-8
/// as
/// `\xff`.
std::string visible(std::string_view text);
/// The same on one line, and what is longer than `most` bytes cut in its middle.
std::string brief(std::string_view text, std::size_t most = 80);

/// Number of characters of UTF-8 text.
std::size_t characters(std::string_view text);
/// One line of up to `most` characters, with … in its middle where it is cut: a label for a narrow place.
std::string shortened(std::string_view text, std::size_t most);

/// The only ways to standard output and standard error: made visible, and never thrown out of.
void print_out(std::string_view text);
void print_error(std::string_view text);
/// Takes back the line that the cursor is on, where standard output is a terminal.
void erase_line();

/// Whether something printed did not arrive, such as on a full disk. A reader that has gone away (`| head`)
/// does not count: it has what it wanted.
bool output_lost();

}  // namespace taut::bench
