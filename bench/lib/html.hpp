#pragma once
/// \file
/// One self-contained page of text, tables and figures.

#include <filesystem>
#include <string>
#include <vector>

namespace taut::bench {

/// Text that may stand in HTML.
std::string escaped(const std::string& text);

/// A cell of a table: text and an optional class ("number", "good", "fair", "bad", "quiet", "wrap", "wide";
/// "#rrggbb" for a swatch).
struct HtmlCell {
  std::string text;
  std::string kind;
};

class HtmlPage {
 public:
  explicit HtmlPage(const std::string& title);

  void heading(int level, const std::string& text);
  void paragraph(const std::string& text, const std::string& kind = "");
  /// Text as it is, line breaks kept.
  void code(const std::string& text);
  void table(const std::vector<std::string>& header, const std::vector<std::vector<HtmlCell>>& rows);
  /// A PNG or SVG file, embedded. \throws RunError
  void figure(const std::filesystem::path& image, const std::string& caption);
  void begin_details(const std::string& summary);
  void end_details();
  /// The whole page.
  std::string str() const;

 private:
  std::string title_, body_;
};

}  // namespace taut::bench
