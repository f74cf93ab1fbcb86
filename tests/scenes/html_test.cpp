// Pages of reports.
#include <doctest/doctest.h>

#include <lib/html.hpp>
#include <lib/text_table.hpp>

using namespace taut::bench;

TEST_CASE("text in pages is escaped, names in backticks are set as code") {
  HtmlPage page("A & B");
  page.paragraph("`a<b>` and `c`; one ` alone");
  const std::string text = page.str();
  CHECK(text.find("<h1>A &amp; B</h1>") != std::string::npos);
  CHECK(text.find("<p><code>a&lt;b&gt;</code> and <code>c</code>; one ` alone</p>") != std::string::npos);
}

TEST_CASE("errors that round to zero have no sign") {
  CHECK(signed_percent(0.0125, 1) == "+1.2 %");
  CHECK(signed_percent(-0.0004, 1) == "0.0 %");
  CHECK(signed_percent(-0.0006, 1) == "-0.1 %");
}
