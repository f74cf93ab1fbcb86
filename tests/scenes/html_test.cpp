// Pages of reports.
#include <doctest/doctest.h>

#include <lib/html.hpp>

using namespace taut::bench;

TEST_CASE("text in pages is escaped, names in backticks are set as code") {
  HtmlPage page("A & B");
  page.paragraph("`a<b>` and `c`; one ` alone");
  const std::string text = page.str();
  CHECK(text.find("<h1>A &amp; B</h1>") != std::string::npos);
  CHECK(text.find("<p><code>a&lt;b&gt;</code> and <code>c</code>; one ` alone</p>") != std::string::npos);
}
