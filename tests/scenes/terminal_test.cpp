// Text of others on its way to a terminal, to gnuplot and to file names.
#include <doctest/doctest.h>

#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/terminal.hpp>
#include <type_traits>

using namespace taut::bench;

TEST_CASE("F1: nothing that a terminal obeys passes") {
  CHECK(visible("plain, ν = 0.3 µm\n\tend") == "plain, ν = 0.3 µm\n\tend");
  CHECK(visible("\x1b[31mred\a\r\x7f") == "\\u001b[31mred\\u0007\\u000d\\u007f");
  CHECK(visible(std::string_view("a\0b", 3)) == "a\\u0000b");
  CHECK(visible("\xc2\x9b"
                "31m") == "\\u009b31m");  // C1: CSI in UTF-8
  CHECK(visible("\x9b"
                "31m\xff\xc0\xaf") == "\\x9b31m\\xff\\xc0\\xaf");  // bytes that are no UTF-8, overlong ones
  CHECK(visible("a\u202Eb\u2066c\u200Bd\uFEFF") == "a\\u202eb\\u2066c\\u200bd\\ufeff");
  CHECK(visible("\xed\xa0\x80\xf4\x90\x80\x80").find('\xed') ==
        std::string::npos);  // surrogates, beyond the end
  CHECK(visible("\xe2\x82") == "\\xe2\\x82");
  CHECK(visible(visible("\x1b")) == visible("\x1b"));
}

TEST_CASE("F20: messages cut long text, never inside a character") {
  CHECK(brief("short\nlines") == "short lines");
  const std::string long_text = brief(std::string(1000000, 'x') + "end");
  CHECK(long_text.size() < 120);
  CHECK(long_text.ends_with("end"));
  std::string greek;
  for (int i = 0; i < 1000; ++i) greek += "ν";
  CHECK(visible(brief(greek)) == brief(greek));
  CHECK(brief(greek).find('\\') == std::string::npos);
}

TEST_CASE("labels for narrow places are cut in their middle") {
  CHECK(shortened("abcdef", 6) == "abcdef");
  CHECK(shortened("abcdefg", 6) == "abc…fg");
  CHECK(characters(shortened(std::string(500, 'x'), 40)) == 40);
  CHECK(shortened("ννννννν", 5) == "νν…νν");
  CHECK(characters("ν = 0") == 5);
}

TEST_CASE("F1: gnuplot gets text in single quotes, which hold everything") {
  using gnuplot::Literal;
  using gnuplot::Script;
  CHECK(Literal("`touch x` \"$(y)\" \\").str() == "'`touch x` \"$(y)\" \\'");
  CHECK(Literal("it's\nhere").str() == "'it''s here'");
  CHECK(Literal::file("|touch x").str() == "'./|touch x'");
  CHECK(Literal::file("~/x").str() == "'./~/x'");
  CHECK(Script("set title {} at {}\n", Literal("a'b"), 0.5).str() == "set title 'a''b' at 0.5\n");
  // Text that went through nothing cannot stand in a script.
  static_assert(!gnuplot::ScriptPart<std::string> && !gnuplot::ScriptPart<const char*>);
  static_assert(!std::is_convertible_v<std::string, Literal>);
}

TEST_CASE("F12: file names are portable and as long as file systems take") {
  CHECK(file_name_of("A/B") == "a_b");
  CHECK(file_name_of("../../etc/passwd") == "etc_passwd");
  CHECK(file_name_of("напор") != file_name_of("отпор"));
  CHECK(file_name_of("ν 0.3") == "u03bd_0.3");
  const std::string a = file_name_of(std::string(1000, 'a')), b = file_name_of(std::string(1000, 'a') + 'b');
  CHECK(a.size() == 180);
  CHECK(b.size() == 180);
  CHECK(a != b);
}
