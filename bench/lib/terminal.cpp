#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <lib/terminal.hpp>

namespace taut::bench {
namespace {

/// One character at the front of `text`, and how many bytes it takes; none where they are no UTF-8.
struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;
};

Character first_of(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  char32_t code = lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3f);
  }
  constexpr char32_t least[] = {0, 0, 0x80, 0x800, 0x10000};
  if (code < least[bytes] || code > 0x10ffff || (code >= 0xd800 && code < 0xe000)) return {};
  return {code, bytes};
}

bool obeyed(char32_t c) {
  constexpr char32_t ranges[][2] = {{0, 0x8},         {0xb, 0x1f},        {0x7f, 0x9f},
                                    {0xad, 0xad},     {0x61c, 0x61c},     {0x200b, 0x200f},
                                    {0x2028, 0x202e}, {0x2060, 0x206f},   {0xfeff, 0xfeff},
                                    {0xfff9, 0xfffb}, {0xe0000, 0xe0fff}, {0xf0000, 0x10ffff}};
  return std::any_of(std::begin(ranges), std::end(ranges), [&](auto& r) { return c >= r[0] && c <= r[1]; });
}

bool lost = false;

void print(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      lost = lost || (descriptor == STDOUT_FILENO && errno != EPIPE && errno != EBADF);
      return;
    }
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

/// Messages repeat what was wrong, which may be megabytes.
std::string cut(std::string text, std::size_t most) {
  if (text.size() <= most) return text;
  std::size_t head = 2 * most / 3, tail = text.size() - (most - head);
  const auto inside = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0) == 0x80; };
  while (head > 0 && inside(head)) --head;
  while (tail < text.size() && inside(tail)) ++tail;
  return text.substr(0, head) + fmt::format(" … ({} bytes) … ", tail - head) + text.substr(tail);
}

}  // namespace

std::string visible(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character c = first_of(text);
    if (!c.bytes)
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(text[0]));
    else if (obeyed(c.code))
      out += c.code > 0xffff ? fmt::format("\\U{:08x}", static_cast<unsigned>(c.code))
                             : fmt::format("\\u{:04x}", static_cast<unsigned>(c.code));
    else
      out += text.substr(0, c.bytes);
    text.remove_prefix(std::max<std::size_t>(c.bytes, 1));
  }
  return out;
}

std::string brief(std::string_view text, std::size_t most) {
  // What is cut away need not be looked at; a character that is cut in two becomes bytes.
  std::string line = text.size() > 16 * most
                         ? visible(text.substr(0, 8 * most)) + visible(text.substr(text.size() - 8 * most))
                         : visible(text);
  for (char& c : line)
    if (c == '\n' || c == '\t') c = ' ';
  return cut(std::move(line), most);
}

std::size_t characters(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }));
}

std::string shortened(std::string_view text, std::size_t most) {
  const std::string line = brief(text, 1000);
  const std::size_t all = characters(line);
  if (all <= most) return line;
  const std::size_t head = most / 2, tail = all - (most - 1 - head);  // characters before and from
  std::string cut_text;
  std::size_t number = 0;
  for (const char c : line) {
    number += (static_cast<unsigned char>(c) & 0xc0) != 0x80;
    if (number <= head || number > tail)
      cut_text += c;
    else if (number == head + 1 && cut_text.size() < line.size() && !cut_text.ends_with("…"))
      cut_text += "…";
  }
  return cut_text;
}

void print_out(std::string_view text) { print(STDOUT_FILENO, visible(text)); }

void print_error(std::string_view text) {
  // What was given may be of any length: no word of it stands there in full beyond a long path.
  constexpr std::size_t longest_word = 400;
  const std::string shown = visible(text);
  std::string message;
  for (std::size_t at = 0; at < shown.size() && message.size() <= 20000;) {
    const std::size_t end = std::min(shown.find_first_of(" \n", at), shown.size());
    message += cut(shown.substr(at, end - at), longest_word);
    if (end < shown.size()) message += shown[end];
    at = end + 1;
  }
  print(STDERR_FILENO, cut(std::move(message), 6000));
}

void erase_line() {
  if (isatty(STDOUT_FILENO) == 1) print(STDOUT_FILENO, "\r\033[K");
}

bool output_lost() { return lost; }

}  // namespace taut::bench
