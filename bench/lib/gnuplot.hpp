#pragma once
/// \file
/// gnuplot as a separate program, where it is installed, and text that may stand in its language.

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>

namespace taut::bench::gnuplot {

/// Text as a string of gnuplot's language. Single quotes hold everything as it is (double ones run what
/// stands in backticks); control characters become visible.
class Literal {
 public:
  explicit Literal(std::string_view text);
  /// A file, by a path that gnuplot cannot take for a pipe ("|…") or a home ("~…"). Names with control
  /// characters are none that it finds.
  static Literal file(const std::filesystem::path& path);
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

class Script;

/// What may stand in a script: numbers, literals and other scripts. Text of others is none of these: it has
/// to go through `Literal`.
template <class T>
concept ScriptPart = std::is_arithmetic_v<T> || std::is_same_v<T, Literal> || std::is_same_v<T, Script>;

/// Statements of gnuplot's language. Made of text that stands in this program, known when it is compiled, and
/// of `ScriptPart`s in its braces.
class Script {
 public:
  Script() = default;
  template <ScriptPart... Parts>
  explicit Script(fmt::format_string<const Parts&...> text, const Parts&... parts)
      : text_(fmt::format(text, parts...)) {}
  template <ScriptPart... Parts>
  Script& add(fmt::format_string<const Parts&...> text, const Parts&... parts) {
    text_ += fmt::format(text, parts...);
    return *this;
  }
  bool empty() const { return text_.empty(); }
  const std::string& str() const { return text_; }

 private:
  std::string text_;
};

/// Whether gnuplot can be run. The environment variable TAUT_GNUPLOT names another program, or none when
/// empty.
bool available();

/// Keeps `script` beside `image` (as image.gp) and runs it; `set output` is added here. False when gnuplot is
/// missing, fails, or takes longer than a minute (TAUT_GNUPLOT_SECONDS), with its message in `why`; no image
/// is left then. After one that took too long none is tried again. \throws RunError for files that cannot be
/// written
bool draw(const Script& terminal, const Script& script, const std::filesystem::path& image, std::string& why);

/// Ends a gnuplot that runs. May be called from a signal handler.
void stop() noexcept;

}  // namespace taut::bench::gnuplot

template <>
struct fmt::formatter<taut::bench::gnuplot::Literal> : fmt::formatter<std::string_view> {
  template <class Context>
  auto format(const taut::bench::gnuplot::Literal& literal, Context& context) const {
    return fmt::formatter<std::string_view>::format(literal.str(), context);
  }
};

template <>
struct fmt::formatter<taut::bench::gnuplot::Script> : fmt::formatter<std::string_view> {
  template <class Context>
  auto format(const taut::bench::gnuplot::Script& script, Context& context) const {
    return fmt::formatter<std::string_view>::format(script.str(), context);
  }
};
