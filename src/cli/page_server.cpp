#include "cli/page_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <sys/random.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "castray/error.h"
#include "cli/display_flags.h"
#include "cli/scene_report.h"
#include "cli/serve_page.h"
#include "cli/temporary_folder.h"
#include "cli/values.h"
#include "core/files.h"

namespace castray::cli {

namespace {

using json = nlohmann::ordered_json;

constexpr const char* host = "127.0.0.1";
constexpr std::size_t longest_request = 4096;     ///< bytes
constexpr std::chrono::seconds longest_wait{10};  ///< of a request for the next frame
constexpr std::size_t connections = 16;           ///< at a time
enum Status { bad_request = 400, forbidden = 403, unsupported_type = 415, unavailable = 503 };

std::string random_token() {
  unsigned char bytes[16];
  if (getrandom(bytes, sizeof bytes, 0) != sizeof bytes)
    throw InputError("serve: no random numbers for the token");
  std::string text;
  for (const unsigned char byte : bytes) text += fmt::format("{:02x}", byte);
  return text;
}

/// In a time that does not tell where they differ.
bool equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  int difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= a[i] ^ b[i];
  return difference == 0;
}

json parse_object(const std::string& body) {
  json object = json::parse(body, nullptr, false);
  if (!object.is_object()) throw InputError("expected a JSON object");
  return object;
}

double number_in(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number() || !std::isfinite(found->get<double>()))
    throw InputError(fmt::format("\"{}\": expected a number", key));
  return found->get<double>();
}

template <std::size_t N>
std::array<double, N> numbers_in(const json& object, const char* key) {
  const auto found = object.find(key);
  std::array<double, N> numbers{};
  bool good = found != object.end() && found->is_array() && found->size() == N;
  for (std::size_t i = 0; good && i < N; ++i) {
    good = (*found)[i].is_number() && std::isfinite((*found)[i].template get<double>());
    if (good) numbers[i] = (*found)[i].template get<double>();
  }
  if (!good) throw InputError(fmt::format("\"{}\": expected {} numbers", key, N));
  return numbers;
}

Vec3d vector_in(const json& object, const char* key) {
  const auto [x, y, z] = numbers_in<3>(object, key);
  return {x, y, z};
}

/// The scene's camera, looking as a request says.
Camera camera_of(const Scene& scene, const json& view) {
  const Camera placed =
      make_camera(scene.to_scene(vector_in(view, "position")), scene.to_scene(vector_in(view, "look_at")),
                  vector_in(view, "up"), number_in(view, "fov"));
  Camera camera = scene.camera;
  camera.position = placed.position;
  camera.forward = placed.forward, camera.right = placed.right, camera.up = placed.up;
  camera.tan_half_fov = placed.tan_half_fov;
  // What a parallel projection shows is as large as if the camera's distance mattered.
  camera.half_height *= view_distance(placed) / view_distance(scene.camera);
  return camera;
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(json{{"error", why}}.dump(-1, ' ', false, json::error_handler_t::replace),
                       "application/json");
}

/// A view that no camera has, or a body that is no JSON, is the request's fault.
template <class Take>
httplib::Server::Handler taker(Take take) {
  return [take](const httplib::Request& request, httplib::Response& response) {
    if (!request.get_header_value("Content-Type").starts_with("application/json"))
      return refuse(response, unsupported_type, "expected application/json");
    try {
      take(request.body);
      response.set_content("{}", "application/json");
    } catch (const InputError& error) {
      refuse(response, bad_request, error.what());
    }
  };
}

}  // namespace

PageServer::PageServer(const ServedScene& served, LiveRender& render, int port)
    : served_(served),
      render_(render),
      token_(random_token()),
      server_(std::make_unique<httplib::Server>()),
      port_(port) {
  server_->new_task_queue = [] { return new httplib::ThreadPool(connections); };
  server_->set_keep_alive_max_count(1);
  server_->set_payload_max_length(longest_request);
  // A port that another program listens on is not shared with it.
  server_->set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  declare_routes();
  if (port == 0) port_ = server_->bind_to_any_port(host);
  if (port_ < 0 || (port != 0 && !server_->bind_to_port(host, port)))
    throw InputError(
        fmt::format("--port {}: cannot be listened on; it may be taken, leave the flag out", port));
  listener_ = std::thread([this] { server_->listen_after_bind(); });
  while (!server_->is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

PageServer::~PageServer() {
  render_.stop();  // nobody waits for frames any more
  server_->stop();
  listener_.join();
}

std::string PageServer::address() const { return fmt::format("http://{}:{}/{}/", host, port_, token_); }

void PageServer::declare_routes() {
  server_->set_default_headers(
      {{"Cache-Control", "no-store"},
       {"X-Content-Type-Options", "nosniff"},
       {"Referrer-Policy", "no-referrer"},
       {"Cross-Origin-Resource-Policy", "same-origin"},
       {"Content-Security-Policy",
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; "
        "img-src data:; connect-src 'self'; frame-ancestors 'none'; base-uri 'none'"}});
  server_->set_pre_routing_handler([this](const Request& request, Response& response) {
    if (is_allowed(request)) return httplib::Server::HandlerResponse::Unhandled;
    refuse(response, forbidden, "this is not the address that castray serve printed");
    return httplib::Server::HandlerResponse::Handled;
  });
  const std::string root = "/" + token_ + "/";
  server_->Get(root, [this](const Request&, Response& response) {
    std::string page = serve_page;
    constexpr std::string_view place = "@DATA@";
    const json data{{"name", served_.name}, {"exposure", served_.exposure}, {"version", CASTRAY_VERSION}};
    std::string text = data.dump(-1, ' ', true, json::error_handler_t::replace);
    for (std::size_t at = 0; (at = text.find('<', at)) != text.npos;) text.replace(at, 1, "\\u003c");
    response.set_content(page.replace(page.find(place), place.size(), text), "text/html; charset=utf-8");
  });
  server_->Get(root + "frame", [this](const Request& q, Response& r) { send_frame(q, r); });
  for (const char* suffix : {".exr", ".png"})
    server_->Get(root + "image\\" + suffix,
                 [this, suffix](const Request& q, Response& r) { send_image(q, r, suffix); });
  server_->Post(root + "look", taker([this](const std::string& body) { take_look(body); }));
  server_->Post(root + "refine", taker([this](const std::string& body) { take_part(body); }));
  server_->Post(root + "pause", taker([this](const std::string& body) { take_pause(body); }));
}

bool PageServer::is_allowed(const Request& request) const {
  const std::string names[] = {fmt::format("{}:{}", host, port_), fmt::format("localhost:{}", port_)};
  const auto is_here = [&](std::string_view prefix, const std::string& value) {
    return std::any_of(std::begin(names), std::end(names),
                       [&](const std::string& name) { return value == std::string(prefix) + name; });
  };
  if (request.get_header_value_count("Host") != 1 || !is_here("", request.get_header_value("Host")))
    return false;
  if (request.has_header("Origin") && !is_here("http://", request.get_header_value("Origin"))) return false;
  const std::string_view path = request.path;
  return path.size() > token_.size() + 1 && path[0] == '/' && path[token_.size() + 1] == '/' &&
         equal(path.substr(1, token_.size()), token_);
}

std::string PageServer::frame_text(const LiveFrame& frame) const {
  json text{{"number", frame.number},
            {"width", frame.width},
            {"height", frame.height},
            {"columns", frame.image.width},
            {"rows", frame.image.height},
            {"spp", frame.spp},
            {"samples_per_second", std::round(frame.samples_per_second)},
            {"paused", render_.paused()},
            {"done", frame.done},
            {"flags", view_flags(served_.scene, frame.camera)},
            {"json", view_json(served_.scene, frame.camera)}};
  if (const auto& part = frame.refined) text["refined"] = {part->x0, part->y0, part->x1, part->y1};
  return text.dump(-1, ' ', true, json::error_handler_t::replace);
}

/// Linear radiance, floats of red, green and blue, top row first, once there is a frame after "after".
void PageServer::send_frame(const Request& request, Response& response) const {
  std::uint64_t after = 0;
  try {
    if (request.has_param("after"))
      after = parse_whole("after", request.get_param_value("after"), 0, ~std::uint64_t{0});
  } catch (const InputError& error) {
    return refuse(response, bad_request, error.what());
  }
  const auto frame = render_.frame_after(after, longest_wait);
  if (!frame) {
    response.status = 204;
    return;
  }
  response.set_header("Castray-Frame", frame_text(*frame));
  const auto& pixels = frame->image.pixels;
  response.set_content(reinterpret_cast<const char*>(pixels.data()), pixels.size() * sizeof pixels[0],
                       "application/octet-stream");
}

Metadata PageServer::metadata(const LiveFrame& frame) const {
  Metadata metadata = frame.metadata;
  metadata.erase("castray:hash");  // of the scene's own view
  metadata.erase("castray:view");
  add_writer(metadata);
  metadata["castray:options"] += fmt::format(" {} --spp {:.0f}{}", view_flags(served_.scene, frame.camera),
                                             std::ceil(frame.spp), served_.flags);
  if (const auto& part = frame.refined)
    metadata["castray:refined"] = fmt::format("{},{},{},{}", part->x0, part->y0, part->x1, part->y1);
  return metadata;
}

/// The image so far, to be downloaded.
void PageServer::send_image(const Request& request, Response& response, const char* suffix) const {
  Display display;
  try {
    if (request.has_param("exposure"))
      display.exposure = parse_number("exposure", request.get_param_value("exposure"));
    if (std::abs(display.exposure) > 100) throw InputError("exposure: must be between -100 and 100");
  } catch (const InputError& error) {
    return refuse(response, bad_request, error.what());
  }
  auto frame = render_.frame_after(0, longest_wait);
  while (frame && frame->image.width != frame->width)
    frame = render_.frame_after(frame->number, longest_wait);
  if (!frame) return refuse(response, unavailable, "there is no whole image yet");
  const TemporaryFolder folder;
  const auto file = folder.path() / (std::string("image") + suffix);
  write_image(file, frame->image, display, metadata(*frame));
  response.set_header("Content-Disposition",
                      fmt::format("attachment; filename=\"{}{}\"", as_file_name(served_.name), suffix));
  response.set_content(read_file(file), "application/octet-stream");
}

void PageServer::take_look(const std::string& body) {
  render_.look(camera_of(served_.scene, parse_object(body)));
}

/// {"window": [X0, Y0, X1, Y1]}, or null for the whole.
void PageServer::take_part(const std::string& body) {
  const json object = parse_object(body);
  if (object.contains("window") && object["window"].is_null()) return render_.refine(std::nullopt);
  const auto edges = numbers_in<4>(object, "window");
  const int width = served_.scene.width, height = served_.scene.height;
  const auto edge = [&](std::size_t i, int most) {
    return static_cast<int>(std::lround(std::clamp(edges[i], 0.0, static_cast<double>(most))));
  };
  const Window part{width, height, edge(0, width), edge(1, height), edge(2, width), edge(3, height)};
  if (part.x0 >= part.x1 || part.y0 >= part.y1) throw InputError("\"window\": has no pixel");
  render_.refine(part);
}

void PageServer::take_pause(const std::string& body) {
  const json object = parse_object(body);
  const auto found = object.find("paused");
  if (found == object.end() || !found->is_boolean()) throw InputError("\"paused\": expected true or false");
  render_.pause(found->get<bool>());
}

}  // namespace castray::cli
