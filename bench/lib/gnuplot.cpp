#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <lib/files.hpp>
#include <lib/gnuplot.hpp>
#include <vector>

namespace taut::bench {
namespace {

std::string program() {
  const char* named = std::getenv("TAUT_GNUPLOT");
  return named ? named : "gnuplot";
}

/// Runs a program without a shell, its output to a file; its exit status, or -1.
int run(const std::vector<std::string>& arguments, const std::filesystem::path& output) {
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const std::string log = output.string();
  const pid_t child = fork();
  if (child < 0) return -1;
  if (child == 0) {
    if (!std::freopen(log.c_str(), "w", stdout) || dup2(fileno(stdout), 2) < 0) _exit(127);
    execvp(argv[0], argv.data());
    _exit(127);
  }
  int status = 0;
  if (waitpid(child, &status, 0) < 0 || !WIFEXITED(status)) return -1;
  return WEXITSTATUS(status);
}

}  // namespace

bool gnuplot_available() {
  static const bool available = !program().empty() && run({program(), "--version"}, "/dev/null") == 0;
  return available;
}

bool run_gnuplot(const std::string& terminal, const std::string& script, const std::filesystem::path& image,
                 std::string& why) {
  const std::filesystem::path temporary = image.string() + ".tmp", log = image.string() + ".log";
  const std::filesystem::path file = image.string() + ".gp";
  write_file(file, "set terminal " + terminal + "\nset output " + quoted(temporary.string()) + '\n' + script);
  if (!gnuplot_available()) {
    why = "gnuplot was not found";
    return false;
  }
  const int status = run({program(), file.string()}, log);
  why = read_file(log);
  std::error_code error;
  std::filesystem::remove(log, error);
  if (status != 0 || !std::filesystem::exists(temporary) || std::filesystem::file_size(temporary) == 0) {
    std::filesystem::remove(temporary, error);
    if (why.empty()) why = "gnuplot failed";
    return false;
  }
  // The kept script draws the image itself, not the temporary one.
  write_file(
      file, "set terminal " + terminal + "\nset output " + quoted(image.filename().string()) + '\n' + script);
  std::filesystem::rename(temporary, image);
  return true;
}

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + '"';
}

}  // namespace taut::bench
