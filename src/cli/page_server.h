#pragma once

#include <memory>
#include <string>
#include <thread>

#include "castray/scene.h"
#include "cli/live_render.h"

namespace httplib {
class Server;
struct Request;
struct Response;
}  // namespace httplib

namespace castray::cli {

/// What the page is told besides its frames.
struct ServedScene {
  const Scene& scene;
  std::string name;     ///< for the title, and of saved files
  std::string flags;    ///< " --name value ...": those that, with a view, render the image again
  double exposure = 0;  ///< stops, to begin with
};

/// The web page of `castray serve`, for this machine alone: on 127.0.0.1, under an address that begins with a
/// random token. Requests without the token, for another host (as of a name that was made to lead here) or
/// from another site's page are refused.
class PageServer {
 public:
  /// Listens. `port` 0: any that is free. Throws InputError where it is taken.
  PageServer(const ServedScene& served, LiveRender& render, int port);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// "http://127.0.0.1:PORT/TOKEN/".
  std::string address() const;

 private:
  using Request = httplib::Request;
  using Response = httplib::Response;

  void declare_routes();
  bool is_allowed(const Request& request) const;
  void send_frame(const Request& request, Response& response) const;
  void send_image(const Request& request, Response& response, const char* suffix) const;
  void take_look(const std::string& body);
  void take_part(const std::string& body);
  void take_pause(const std::string& body);
  std::string frame_text(const LiveFrame& frame) const;
  Metadata metadata(const LiveFrame& frame) const;

  ServedScene served_;
  LiveRender& render_;
  std::string token_;
  std::unique_ptr<httplib::Server> server_;
  int port_;
  std::thread listener_;
};

}  // namespace castray::cli
