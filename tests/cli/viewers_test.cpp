#include <catch2/catch.hpp>

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstring>
#include <thread>

#include "castray/film.h"
#include "cli/terminal_preview.h"
#include "core/files.h"
#include "endless_render.h"
#include "run_castray.h"
#include "screen.h"
#include "terminal.h"
#include "words.h"

using namespace castray;
using Catch::Contains;
using test::endless_render;

namespace {

/// Listens as tev does, to one connection, and keeps what comes.
class Listener {
 public:
  Listener() : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || listen(socket_, 1) != 0 ||
        getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      throw std::runtime_error("cannot listen");
    port_ = ntohs(address.sin_port);
  }
  ~Listener() {
    if (reader_.joinable()) bytes();
    close(socket_);
  }
  std::string port() const { return std::to_string(port_); }
  /// `most`: the connection is closed after so many bytes.
  void start(std::size_t most = ~std::size_t{0}) {
    reader_ = std::thread([this, most] {
      const int connection = accept(socket_, nullptr, nullptr);
      char buffer[4096];
      for (ssize_t n; bytes_.size() < most && (n = read(connection, buffer, sizeof buffer)) > 0;)
        bytes_.append(buffer, static_cast<std::size_t>(n));
      close(connection);
    });
  }
  const std::string& bytes() {
    if (reader_.joinable()) reader_.join();
    return bytes_;
  }

 private:
  int socket_;
  std::uint16_t port_ = 0;
  std::string bytes_;
  std::thread reader_;
};

/// Takes fields off a packet.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  template <class T>
  T number() {
    T value;
    REQUIRE(rest_.size() >= sizeof value);
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  std::string text() {
    const std::size_t end = rest_.find('\0');
    REQUIRE(end != std::string_view::npos);
    const std::string value(rest_.substr(0, end));
    rest_.remove_prefix(end + 1);
    return value;
  }
  std::string_view rest() const { return rest_; }

 private:
  std::string_view rest_;
};

RunResult render_to_tev(const TemporaryFolder& folder, const std::string& port) {
  return run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "24x16", "--spp", "64",
                      "--tev", "127.0.0.1:" + port, "-o", "x.film", "--reconstruct", "on"},
                     folder.path());
}

/// The film's image, which its means alone are not.
Image reconstructed(const std::filesystem::path& file) {
  const Film film = read_film(file);
  const Image image = image_of(film);
  CHECK(image.pixels != film.image().pixels);
  return image;
}

// What the preview writes to a terminal, and what a user does.
constexpr const char *frame = "\x1b[H", *cleared = "\x1b[2J", *shell_again = "\x1b[0m\x1b[?25h\x1b[?1049l",
                     *ctrl_c = "\x03";

/// Without "\r", which terminals add.
std::string with_plain_ends(std::string text) {
  std::erase(text, '\r');
  return text;
}

/// The terminal itself shows Ctrl-C as "^C", wherever the cursor is.
std::string without_echo(std::string text) {
  for (std::size_t at; (at = text.find("^C")) != std::string::npos;) text.erase(at, 2);
  return text;
}

}  // namespace

TEST_CASE(
    "tev gets an image of the right size and channels, and in the end the whole picture, reconstructed") {
  const TemporaryFolder folder;
  Listener tev;
  tev.start();
  const RunResult run = render_to_tev(folder, tev.port());
  CAPTURE(run.err);
  REQUIRE(run.exit_code == 0);
  const Image expected = reconstructed(folder / "x.film");
  std::string_view bytes = tev.bytes();
  int packets = 0;
  std::string_view last;
  while (!bytes.empty()) {
    const auto length = Reader(bytes).number<std::uint32_t>();
    REQUIRE(length <= bytes.size());
    Reader packet(bytes.substr(4, length - 4));
    const int operation = packet.number<std::uint8_t>();
    packet.number<std::uint8_t>();  // focus
    CHECK(packet.text() == "cornell_box");
    CHECK(operation == (packets == 0 ? 4 : 6));
    if (operation == 4) {
      CHECK(packet.number<std::int32_t>() == 24);
      CHECK(packet.number<std::int32_t>() == 16);
    }
    CHECK(packet.number<std::int32_t>() == 3);
    for (const char* channel : {"R", "G", "B"}) CHECK(packet.text() == channel);
    if (operation == 6) {
      for (const int value : {0, 0, 24, 16}) CHECK(packet.number<std::int32_t>() == value);
      for (const int offset : {0, 1, 2}) CHECK(packet.number<std::int64_t>() == offset);
      for (int c = 0; c < 3; ++c) CHECK(packet.number<std::int64_t>() == 3);
      CHECK(packet.rest().size() == 24 * 16 * 3 * sizeof(float));
      last = packet.rest();
    }
    bytes.remove_prefix(length);
    ++packets;
  }
  CHECK(packets >= 2);
  REQUIRE(last.size() == expected.pixels.size() * sizeof(Vec3f));
  CHECK(std::memcmp(last.data(), expected.pixels.data(), last.size()) == 0);
}

TEST_CASE("a render goes on when tev is gone, and does not start without it") {
  const TemporaryFolder folder;
  std::string port;
  {
    Listener tev;
    port = tev.port();
    tev.start(1);
    const RunResult run = render_to_tev(folder, port);
    CHECK(run.exit_code == 0);
    CHECK(std::filesystem::exists(folder / "x.film"));
    std::filesystem::remove(folder / "x.film");
  }
  const RunResult refused = render_to_tev(folder, port);
  CHECK(refused.exit_code == 2);
  CHECK_THAT(refused.err, Contains("--tev 127.0.0.1:" + port + ": no tev answers: Connection refused"));
  CHECK_FALSE(std::filesystem::exists(folder / "x.film"));
}

TEST_CASE("half blocks show two rows of pixels in one of characters, within the terminal") {
  Image image(2, 2);
  image.at(0, 0) = {1, 0, 0};
  image.at(1, 0) = {0, 1, 0};
  image.at(0, 1) = {0, 0, 1};
  image.at(1, 1) = {1, 1, 1};
  CHECK(
      cli::half_blocks(image, {}, 2, 1) ==
      "\x1b[38;2;255;0;0m\x1b[48;2;0;0;255m\u2580\x1b[38;2;0;255;0m\x1b[48;2;255;255;255m\u2580\x1b[0m\r\n");
  // Shrunk by means of light, not of encoded values: half of the light is 188 of 255 in sRGB.
  Image stripes(4, 4);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; x += 2) stripes.at(x, y) = {1, 1, 1};
  CHECK_THAT(cli::half_blocks(stripes, {}, 2, 1), Contains("\x1b[38;2;188;188;188m"));
  for (const auto& [columns, rows] : {std::pair{80, 24}, std::pair{7, 3}, std::pair{1, 1}}) {
    const std::string text = cli::half_blocks(Image(300, 20), {}, columns, rows);
    const std::size_t lines = count_of(text, "\r\n"), characters = count_of(text, "\u2580");
    CHECK(lines <= static_cast<std::size_t>(rows));
    CHECK(characters == lines * static_cast<std::size_t>(columns));
  }
}

TEST_CASE("a snapshot of the outputs is reconstructed") {
  const TemporaryFolder folder;
  CastrayProcess process(
      endless_render({"--reconstruct", "on", "--progress", "lines", "-o", "x.pfm", "-o", "x.film"}),
      {.folder = folder.path()});
  process.wait_until([&] { return !process.err().empty(); });
  process.send(SIGUSR1);
  REQUIRE(process.wait_until([&] { return process.err().find("snapshot of") != std::string::npos; }));
  CHECK(read_image(folder / "x.pfm").image.pixels == reconstructed(folder / "x.film").pixels);
}

TEST_CASE("the terminal shows the reconstructed image") {
  const TemporaryFolder folder;
  Terminal terminal(60, 20);
  const RunResult run =
      run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "32x32", "--spp", "4",
                   "--reconstruct", "on", "--preview", "terminal", "-o", "x.film"},
                  {.folder = folder.path(), .error_file = terminal.name()});
  CHECK(run.exit_code == 0);
  const std::string expected = cli::half_blocks(reconstructed(folder / "x.film"), {}, 60, 19);
  CHECK(with_plain_ends(terminal.text()).find(with_plain_ends(expected)) != std::string::npos);
}

TEST_CASE("the preview follows the terminal's size, Ctrl-C gives the screen back and saves the image") {
  const TemporaryFolder folder;
  Terminal terminal(40, 12);
  CastrayProcess process(endless_render({"--preview", "terminal", "--threads", "1", "-o", "x.film"}),
                         {.folder = folder.path(),
                          .input_file = terminal.name(),
                          .error_file = terminal.name(),
                          .own_session = true});
  const auto frames = [&] { return count_of(terminal.text_so_far(), frame); };
  REQUIRE(process.wait_until([&] { return frames() >= 2; }));
  terminal.resize(20, 10);
  REQUIRE(process.wait_until([&] { return count_of(terminal.text_so_far(), cleared) >= 3; }));
  const std::size_t then = frames();
  REQUIRE(process.wait_until([&] { return frames() > then; }));
  REQUIRE(terminal.type(ctrl_c));
  CHECK(process.wait().exit_code == 130);
  CHECK(read_film(folder / "x.film").samples_per_pixel() > 0);

  const std::string text = without_echo(terminal.text());
  const std::size_t resized = text.rfind(cleared), left = text.rfind(shell_again);
  Screen first(40, 12), second(20, 10);
  first.show(std::string_view(text).substr(0, resized));
  second.show(std::string_view(text).substr(resized, left - resized));
  for (const Screen* screen : {&first, &second}) {
    CHECK_FALSE(screen->wrapped());
    CHECK_FALSE(screen->scrolled());
  }
  CHECK(first.is_own());
  CHECK_FALSE(first.shows_cursor());
  for (int row = 0; row < 11; ++row) CHECK(first.width(row) == 22);  // a square of 22x22 pixels
  for (int row = 0; row < 9; ++row) CHECK(second.width(row) == 18);
  CHECK_THAT(second.line(9), Contains(" %"));
  second.show(std::string_view(text).substr(left));
  CHECK_FALSE(second.is_own());
  CHECK(second.shows_cursor());
}

TEST_CASE("a second interrupt ends the program at once, and gives the screen back too") {
  const TemporaryFolder folder;
  Terminal terminal(40, 12);
  CastrayProcess process(endless_render({"--preview", "terminal", "--threads", "1", "-o", "x.film"}),
                         {.folder = folder.path(), .error_file = terminal.name()});
  REQUIRE(process.wait_until([&] { return count_of(terminal.text_so_far(), frame) > 0; }));
  for (const int signal : {SIGSTOP, SIGINT, SIGTERM, SIGCONT}) process.send(signal);
  CHECK(process.wait().exit_code > 128);
  CHECK(folder.names().empty());
  Screen screen(40, 12);
  screen.show(terminal.text());
  CHECK_FALSE(screen.is_own());
  CHECK(screen.shows_cursor());
}

TEST_CASE("a preview needs a terminal") {
  const TemporaryFolder folder;
  const RunResult run = run_castray({"render", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "8x8",
                                     "--spp", "1", "--preview", "terminal", "-o", "x.pfm"},
                                    folder.path());
  CHECK(run.exit_code == 2);
  CHECK_THAT(run.err, Contains("--preview terminal: the standard error is no terminal"));
}
