#include <signal.h>

#include <atomic>
#include <cstdlib>
#include <lib/child.hpp>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <lib/terminal.hpp>
#include <taut/output/output_file.hpp>

namespace taut::bench::gnuplot {
namespace {

std::string program() {
  const char* given = std::getenv("TAUT_GNUPLOT");
  const std::string named = given ? given : "gnuplot";
  // It is started in another folder.
  return named.find('/') == named.npos ? named : std::filesystem::absolute(named).string();
}

double seconds() {
  const char* given = std::getenv("TAUT_GNUPLOT_SECONDS");
  const double value = given ? std::atof(given) : 0;
  return value > 0 ? value : 60;
}

std::atomic<pid_t> running{0};
/// Set by the first that took too long.
std::string& hung() {
  static std::string text;
  return text;
}

ChildResult run(const std::vector<std::string>& arguments, const std::filesystem::path& folder) {
  ChildResult result = run_child(arguments, folder, seconds(), running);
  if (result.timed_out) hung() = fmt::format("gnuplot did not end within {:g} s", seconds());
  return result;
}

}  // namespace

Literal::Literal(std::string_view text) : text_(1, '\'') {
  for (const char c : visible(text)) {
    if (c == '\'') text_ += '\'';
    text_ += c == '\n' || c == '\t' ? ' ' : c;
  }
  text_ += '\'';
}

Literal Literal::file(const std::filesystem::path& path) {
  return Literal(path.is_absolute() ? path.string() : "./" + path.string());
}

bool available() {
  static const bool found = !program().empty() && run({program(), "--version"}, ".").status == 0;
  return found || !hung().empty();
}

bool draw(const Script& terminal, const Script& script, const std::filesystem::path& image,
          std::string& why) {
  const std::filesystem::path file = image.string() + ".gp";
  // The kept script draws the image itself, not the temporary one.
  const Script head("set terminal {}\n", terminal);
  const Script kept("{}set output {}\n{}", head, Literal::file(image.filename()), script);
  if (!available() || !hung().empty()) {
    write_file(file, kept.str());
    why = available() ? hung() : "gnuplot was not found";
    return false;
  }
  internal::OutputFile picture(image), drawing(file);
  // In the folder of the image, so that no more than plain names is handed over: the path to it may hold
  // anything.
  const auto name = [](const internal::OutputFile& out) {
    return std::filesystem::path(out.temporary()).filename();
  };
  drawing.write(Script("{}set output {}\n{}", head, Literal::file(name(picture)), script).str());
  // Without the user's own settings.
  const ChildResult result =
      run({program(), "--default-settings", name(drawing).string()}, image.parent_path());
  write_file(file, kept.str());
  why = brief(result.timed_out ? hung() : result.output, 400);
  std::error_code error;
  if (result.status != 0 || std::filesystem::file_size(picture.temporary(), error) == 0 || error) {
    if (why.empty()) why = "gnuplot failed";
    return false;
  }
  picture.commit();
  return true;
}

void stop() noexcept {
  if (const pid_t child = running) kill(-child, SIGKILL);
}

}  // namespace taut::bench::gnuplot
