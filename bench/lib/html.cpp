#include <fmt/format.h>

#include <lib/files.hpp>
#include <lib/html.hpp>

namespace taut::bench {
namespace {

constexpr const char* style = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 system-ui, -apple-system, "Segoe UI", "DejaVu Sans", sans-serif; color: #1c2126; background: #fff;
       max-width: 1160px; margin: 2.5rem auto 5rem; padding: 0 1.25rem; }
h1 { font-size: 1.9rem; line-height: 1.2; margin: 0 0 .4rem; }
h2 { font-size: 1.4rem; margin: 2.8rem 0 .6rem; padding-top: .8rem; border-top: 1px solid #d8dde2; }
h3 { font-size: 1.08rem; margin: 1.9rem 0 .4rem; }
p { max-width: 78ch; margin: .5rem 0; }
p.quiet, figcaption { color: #5b6570; font-size: .92rem; }
p.lead { font-size: 1.06rem; }
.scroll { overflow-x: auto; margin: .7rem 0 1rem; }
table { border-collapse: collapse; font-size: .84rem; }
th, td { padding: .32rem .7rem .32rem 0; text-align: left; vertical-align: top; border-bottom: 1px solid #e6eaee; white-space: nowrap; }
th { font-weight: 600; color: #444d56; border-bottom: 1.5px solid #aeb6be; white-space: normal; vertical-align: bottom; }
td.number, th.number { text-align: right; font-variant-numeric: tabular-nums; }
td.good { color: #1e7b45; font-weight: 600; } td.bad { color: #b3261e; font-weight: 600; } td.quiet { color: #7a848d; } td.fair { color: #9a6700; }
td.number.good, td.number.bad { font-weight: 400; }
td.wrap { white-space: normal; min-width: 7.5rem; }
td.wide { white-space: normal; min-width: 22rem; }
figure { margin: 1rem 0 1.6rem; } figure img { max-width: 100%; height: auto; display: block; } figcaption { max-width: 90ch; margin-top: .3rem; }
.swatch { display: inline-block; width: .8em; height: .8em; border-radius: 2px; margin-right: .45em; vertical-align: -.05em; }
code { font: .92em ui-monospace, "DejaVu Sans Mono", monospace; }
pre { background: #f4f6f8; padding: .6rem .8rem; overflow-x: auto; font-size: .85rem; }
summary { cursor: pointer; color: #0b5cad; margin: .6rem 0; }
)";

std::string base64(const std::string& bytes) {
  static constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    unsigned group = 0;
    for (std::size_t k = 0; k < 3; ++k)
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      out += i + k < bytes.size() + 1 ? digits[group >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

namespace {

/// Names in backticks, as scenes and rules write them, in a fixed-width face.
std::string with_code(const std::string& text) {
  std::string out;
  std::size_t done = 0;
  for (;;) {
    const std::size_t open = text.find('`', done),
                      close = open == text.npos ? open : text.find('`', open + 1);
    if (close == text.npos) return out + escaped(text.substr(done));
    out += escaped(text.substr(done, open - done)) + "<code>" +
           escaped(text.substr(open + 1, close - open - 1)) + "</code>";
    done = close + 1;
  }
}

}  // namespace

HtmlPage::HtmlPage(const std::string& title) : title_(title) { heading(1, title); }

void HtmlPage::heading(int level, const std::string& text) {
  body_ += fmt::format("<h{0}>{1}</h{0}>\n", level, escaped(text));
}

void HtmlPage::paragraph(const std::string& text, const std::string& kind) {
  body_ += kind.empty() ? fmt::format("<p>{}</p>\n", with_code(text))
                        : fmt::format("<p class=\"{}\">{}</p>\n", kind, with_code(text));
}

void HtmlPage::code(const std::string& text) { body_ += "<pre>" + escaped(text) + "</pre>\n"; }

void HtmlPage::table(const std::vector<std::string>& header, const std::vector<std::vector<HtmlCell>>& rows) {
  body_ += "<div class=\"scroll\"><table><thead><tr>";
  for (std::size_t c = 0; c < header.size(); ++c) {
    const bool number =
        !rows.empty() && c < rows[0].size() && rows[0][c].kind.find("number") != std::string::npos;
    body_ += fmt::format("<th{}>{}</th>", number ? " class=\"number\"" : "", escaped(header[c]));
  }
  body_ += "</tr></thead><tbody>\n";
  for (const auto& row : rows) {
    body_ += "<tr>";
    for (const HtmlCell& cell : row) {
      if (cell.kind.starts_with('#'))
        body_ += fmt::format("<td><span class=\"swatch\" style=\"background:{}\"></span>{}</td>", cell.kind,
                             escaped(cell.text));
      else
        body_ += fmt::format("<td{}>{}</td>", cell.kind.empty() ? "" : " class=\"" + cell.kind + '"',
                             with_code(cell.text));
    }
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void HtmlPage::figure(const std::filesystem::path& image, const std::string& caption) {
  const std::string type = image.extension() == ".svg" ? "svg+xml" : "png";
  body_ += fmt::format(
      "<figure><img alt=\"{}\" src=\"data:image/{};base64,{}\"><figcaption>{}</figcaption></figure>\n",
      escaped(caption), type, base64(read_file(image)), with_code(caption));
}

void HtmlPage::begin_details(const std::string& summary) {
  body_ += fmt::format("<details><summary>{}</summary>\n", escaped(summary));
}

void HtmlPage::end_details() { body_ += "</details>\n"; }

std::string HtmlPage::str() const {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
      "content=\"width=device-width, "
      "initial-scale=1\"><title>{}</title><style>{}</style></head>\n<body>\n{}</body></html>\n",
      escaped(title_), style, body_);
}

}  // namespace taut::bench
