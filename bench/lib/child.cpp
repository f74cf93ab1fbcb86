#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <lib/child.hpp>

extern char** environ;

namespace taut::bench {
namespace {

using Clock = std::chrono::steady_clock;

/// Set-up of a child in a way that is undone.
struct Spawn {
  posix_spawn_file_actions_t files;
  posix_spawnattr_t attributes;
  Spawn() {
    posix_spawn_file_actions_init(&files);
    posix_spawnattr_init(&attributes);
  }
  Spawn(const Spawn&) = delete;
  Spawn& operator=(const Spawn&) = delete;
  ~Spawn() {
    posix_spawn_file_actions_destroy(&files);
    posix_spawnattr_destroy(&attributes);
  }
};

}  // namespace

ChildResult run_child(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                      double seconds, std::atomic<pid_t>& running) {
  ChildResult result;
  std::vector<char*> argv;
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return result;

  Spawn how;
  posix_spawn_file_actions_addchdir_np(&how.files, folder.c_str());
  posix_spawn_file_actions_addopen(&how.files, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&how.files, ends[1], 1);
  posix_spawn_file_actions_adddup2(&how.files, ends[1], 2);
  sigset_t all, none;
  sigfillset(&all);
  sigemptyset(&none);
  posix_spawnattr_setsigdefault(&how.attributes, &all);
  posix_spawnattr_setsigmask(&how.attributes, &none);
  posix_spawnattr_setpgroup(&how.attributes, 0);
  posix_spawnattr_setflags(&how.attributes,
                           POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
  pid_t child = 0;
  const int failed = posix_spawnp(&child, argv[0], &how.files, &how.attributes, argv.data(), environ);
  close(ends[1]);
  if (failed) {
    close(ends[0]);
    result.output = std::strerror(failed);
    return result;
  }
  running = child;

  const auto deadline = Clock::now() + std::chrono::duration<double>(seconds);
  const auto left = [&] {
    return std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
  };
  // Until its end of the pipe is closed, and then until it has ended.
  int status = 0;
  bool open = true;
  for (;;) {
    const auto wait = left();
    if (wait <= 0) {
      result.timed_out = true;
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      break;
    }
    pollfd look{ends[0], POLLIN, 0};
    // A grandchild may hold the pipe open: the child itself is looked at too.
    const int ready = poll(&look, open ? 1 : 0, static_cast<int>(std::min<long>(wait, open ? 200 : 10)));
    if (open && ready > 0) {
      char buffer[4096];
      const ssize_t got = read(ends[0], buffer, sizeof buffer);
      if (got > 0 && result.output.size() < 65536)
        result.output.append(buffer, static_cast<std::size_t>(got));
      if (got == 0) open = false;
      if (got > 0) continue;
    }
    if (waitpid(child, &status, WNOHANG) == child) break;
  }
  running = 0;
  close(ends[0]);
  if (!result.timed_out && WIFEXITED(status)) result.status = WEXITSTATUS(status);
  return result;
}

}  // namespace taut::bench
