#include "cli/tev.h"

#include <fmt/format.h>
#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <memory>

#include "castray/error.h"

namespace castray::cli {

namespace {

static_assert(std::endian::native == std::endian::little, "packets are written as memory holds them");

enum class Operation : std::uint8_t { create_image = 4, update_image_v3 = 6 };

constexpr const char* channels[] = {"R", "G", "B"};
constexpr std::size_t pixels_of_a_packet = 1 << 18;

class Packet {
 public:
  explicit Packet(Operation operation) { add(std::uint32_t{0}), add(operation); }
  template <class T>
  void add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  void add(const std::string& text) { bytes_.append(text.c_str(), text.size() + 1); }
  void add_channels() {
    add(std::int32_t{std::size(channels)});
    for (const char* channel : channels) add(std::string(channel));
  }
  void append(const Vec3f* pixels, std::size_t count) {
    static_assert(sizeof(Vec3f) == 3 * sizeof(float));
    bytes_.append(reinterpret_cast<const char*>(pixels), count * sizeof *pixels);
  }
  std::string finished() {
    const auto length = static_cast<std::uint32_t>(bytes_.size());
    std::memcpy(bytes_.data(), &length, sizeof length);
    return std::move(bytes_);
  }

 private:
  std::string bytes_;
};

/// Returns -1 with `why` where nothing answers.
int connect_to(const std::string& host, const std::string& port, std::string& why) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = getaddrinfo(host.c_str(), port.c_str(), &wanted, &found)) {
    why = gai_strerror(error);
    return -1;
  }
  const std::unique_ptr<addrinfo, decltype(&freeaddrinfo)> addresses(found, freeaddrinfo);
  for (const addrinfo* address = found; address; address = address->ai_next) {
    const int connection =
        socket(address->ai_family, address->ai_socktype | SOCK_CLOEXEC, address->ai_protocol);
    if (connection >= 0 && connect(connection, address->ai_addr, address->ai_addrlen) == 0) return connection;
    why = std::strerror(errno);
    if (connection >= 0) close(connection);
  }
  return -1;
}

}  // namespace

std::string tev_create_packet(const std::string& name, int width, int height) {
  Packet packet(Operation::create_image);
  packet.add(std::uint8_t{1});  // grab focus
  packet.add(name);
  packet.add(std::int32_t{width});
  packet.add(std::int32_t{height});
  packet.add_channels();
  return packet.finished();
}

std::string tev_update_packet(const std::string& name, const Image& image, int y0, int y1) {
  Packet packet(Operation::update_image_v3);
  packet.add(std::uint8_t{0});  // grab no focus
  packet.add(name);
  packet.add_channels();
  for (const int value : {0, y0, image.width, y1 - y0}) packet.add(std::int32_t{value});
  for (std::int64_t c = 0; c < 3; ++c) packet.add(c);       // where each channel begins, in floats
  for (int c = 0; c < 3; ++c) packet.add(std::int64_t{3});  // from pixel to pixel
  packet.append(&image.at(0, y0), static_cast<std::size_t>(image.width) * static_cast<std::size_t>(y1 - y0));
  return packet.finished();
}

TevViewer::TevViewer(const std::string& address, const std::string& name, int width, int height)
    : address_(address), name_(name) {
  const std::size_t colon = address.rfind(':');
  const std::string host = colon == std::string::npos ? "127.0.0.1" : address.substr(0, colon);
  std::string why;
  socket_ = connect_to(host, address.substr(colon == std::string::npos ? 0 : colon + 1), why);
  if (socket_ < 0)
    throw InputError(
        fmt::format("--tev {}: no tev answers: {}; start it first, its port is 14158", address, why));
  send(tev_create_packet(name, width, height));
}

TevViewer::~TevViewer() {
  if (socket_ >= 0) close(socket_);
}

void TevViewer::show(const Image& image) {
  const int rows =
      static_cast<int>(std::max<std::size_t>(pixels_of_a_packet / static_cast<std::size_t>(image.width), 1));
  for (int y = 0; y < image.height && socket_ >= 0; y += rows)
    send(tev_update_packet(name_, image, y, std::min(y + rows, image.height)));
}

void TevViewer::send(const std::string& packet) {
  for (std::size_t sent = 0; sent < packet.size();) {
    const ssize_t n = ::send(socket_, packet.data() + sent, packet.size() - sent, MSG_NOSIGNAL);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      fmt::print(stderr, "castray: warning: --tev {}: tev is gone; going on without it\n", address_);
      close(socket_);
      socket_ = -1;
      return;
    }
    sent += static_cast<std::size_t>(n);
  }
}

}  // namespace castray::cli
