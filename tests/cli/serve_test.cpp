#include <catch2/catch.hpp>

#include <httplib.h>

#include <atomic>
#include <cstring>
#include <nlohmann/json.hpp>
#include <thread>

#include "castray/image.h"
#include "core/files.h"
#include "run_castray.h"
#include "small_files.h"

using namespace castray;
using Catch::Contains;
using nlohmann::json;

namespace {

/// A running `castray serve` of the Cornell box in 32x24 pixels, and requests as its page sends them.
class Served {
 public:
  explicit Served(std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"serve", CASTRAY_ROOT "/scenes/cornell_box.json", "--size", "32x24"});
    process_.emplace(more, RunSettings{.folder = folder_.path(), .output_file = folder_ / "address"});
    const auto address = [&] { return file_content(folder_ / "address"); };
    process_->wait_until([&] { return address().ends_with("/\n"); });
    const std::string text = address();
    REQUIRE(text.starts_with("http://127.0.0.1:"));
    const std::size_t begin = std::string("http://127.0.0.1:").size(), slash = text.find('/', begin);
    REQUIRE(slash != text.npos);
    port = std::stoi(text.substr(begin, slash - begin));
    root = text.substr(slash, text.size() - slash - 1);
  }

  httplib::Result get(const std::string& what, const httplib::Headers& headers = {}) const {
    httplib::Client client("127.0.0.1", port);
    client.set_read_timeout(std::chrono::seconds(30));  // a frame may be waited for
    return client.Get(root + what, headers);
  }
  httplib::Result post(const std::string& what, const std::string& body,
                       const char* type = "application/json") const {
    return httplib::Client("127.0.0.1", port).Post(root + what, body, type);
  }
  /// The header of the next frame that `wanted` holds of.
  template <class Wanted>
  json frame_where(Wanted wanted) const {
    std::uint64_t number = 0;
    for (int tries = 0; tries < 1000; ++tries) {
      const auto response = get("frame?after=" + std::to_string(number));
      REQUIRE(response);
      if (response->status == 204) continue;
      REQUIRE(response->status == 200);
      json frame = json::parse(response->get_header_value("Castray-Frame"));
      CHECK(response->body.size() ==
            frame["columns"].get<std::size_t>() * frame["rows"].get<std::size_t>() * 12);
      CHECK(frame["number"] > number);
      number = frame["number"];
      if (wanted(frame)) return frame;
    }
    FAIL("no such frame");
    return {};
  }
  json any_frame() const {
    return frame_where([](const json&) { return true; });
  }

  RunResult end() {
    process_->send(SIGINT);
    return process_->wait();
  }

  int port = 0;
  std::string root;  ///< "/TOKEN/"

 private:
  TemporaryFolder folder_;
  std::optional<CastrayProcess> process_;
};

const char* const another_view =
    R"({"position": [278, 273, -700], "look_at": [278, 273, 0], "up": [0, 1, 0], "fov": 50})";

}  // namespace

TEST_CASE("serve: the page is one file without anything from elsewhere, and Ctrl-C ends the program with 0") {
  Served served;
  CHECK(served.root.size() == 34);
  const auto page = served.get("");
  REQUIRE(page);
  CHECK(page->status == 200);
  CHECK_THAT(page->get_header_value("Content-Type"), Contains("text/html"));
  CHECK_THAT(page->get_header_value("Content-Security-Policy"), Contains("default-src 'none'"));
  CHECK_THAT(page->body, Contains("cornell_box") && !Contains("@DATA@") && !Contains("http://") &&
                             !Contains("https://") && !Contains("<link"));
  const RunResult end = served.end();
  CHECK(end.exit_code == 0);
  CHECK_THAT(end.err, Contains("castray: the page above shows "));
}

TEST_CASE("serve: without the token, for another host or from another site a request is refused") {
  Served served;
  httplib::Client client("127.0.0.1", served.port);
  std::string guessed = served.root;
  guessed[1] = guessed[1] == '0' ? '1' : '0';
  for (const std::string& path : {std::string("/"), std::string("/frame"), guessed, guessed + "frame",
                                  served.root.substr(0, served.root.size() - 1), "/x" + served.root}) {
    const auto response = client.Get(path);
    REQUIRE(response);
    INFO(path);
    CHECK(response->status == 403);
    CHECK_THAT(response->body, !Contains(served.root.substr(1, 32)));
  }
  const std::string port = std::to_string(served.port);
  for (const char* host : {"evil.example", "evil.example:80", "127.0.0.1", "localhost.evil.example"})
    CHECK(served.get("frame", {{"Host", host}})->status == 403);
  CHECK(served.get("frame", {{"Host", "127.0.0.1:" + port + ".evil.example"}})->status == 403);
  CHECK(served.get("frame", {{"Host", "localhost:" + port}})->status == 200);
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"})
    CHECK(served.get("frame", {{"Origin", origin}})->status == 403);
  CHECK(served.get("frame", {{"Origin", "http://127.0.0.1:" + port}})->status == 200);
  CHECK(served.get("nothing")->status == 404);
}

TEST_CASE("serve: a request that is wrong is told why, and changes nothing") {
  Served served;
  const std::string before = served.any_frame()["flags"];
  for (const char* body :
       {"", "{", "[]", "1", "{}", R"({"position": [1,2], "look_at": [0,0,0], "up": [0,1,0], "fov": 40})",
        R"({"position": [1,2,"3"], "look_at": [0,0,0], "up": [0,1,0], "fov": 40})",
        R"({"position": [1e999,2,3], "look_at": [0,0,0], "up": [0,1,0], "fov": 40})",
        R"({"position": [1,2,3], "look_at": [1,2,3], "up": [0,1,0], "fov": 40})",
        R"({"position": [1,2,3], "look_at": [0,0,0], "up": [0,0,0], "fov": 40})",
        R"({"position": [1,2,3], "look_at": [0,0,0], "up": [0,1,0], "fov": 500})"}) {
    const auto response = served.post("look", body);
    REQUIRE(response);
    INFO(body << ": " << response->body);
    CHECK(response->status == 400);
    CHECK(json::parse(response->body).contains("error"));
  }
  for (const char* body :
       {R"({"window": [0,0,0,0]})", R"({"window": [5,5,2,2]})", R"({"window": "all"})", "{}"})
    CHECK(served.post("refine", body)->status == 400);
  for (const char* body : {R"({"paused": 1})", "{}"}) CHECK(served.post("pause", body)->status == 400);
  CHECK(served.post("look", another_view, "text/plain")->status == 415);
  CHECK(served.post("look", std::string(100000, ' '))->status == 413);
  CHECK(served.get("frame?after=x")->status == 400);
  CHECK(served.get("image.png?exposure=1e9")->status == 400);
  CHECK(served.any_frame()["flags"] == before);
}

TEST_CASE("serve: frames converge to the image that render makes, at once anew from another view") {
  Served served;
  const json later = served.frame_where([](const json& frame) { return frame["spp"] >= 256; });
  CHECK(later["width"] == 32);
  CHECK(later["columns"] == 32);
  REQUIRE(served.post("look", another_view)->status == 200);
  const json turned = served.frame_where(
      [](const json& frame) { return frame["flags"].get<std::string>().find("-700") != std::string::npos; });
  CHECK_THAT(turned["flags"].get<std::string>(),
             Contains("--look-from 278,273,-700") && Contains("--fov 50"));
  served.frame_where([](const json& frame) { return frame["spp"] >= 256; });
  const auto saved = served.get("image.exr");
  REQUIRE(saved);
  CHECK_THAT(saved->get_header_value("Content-Disposition"), Contains("cornell_box.exr"));
  const TemporaryFolder folder;
  write_file(folder / "saved.exr", saved->body);
  const ImageFile image = read_image(folder / "saved.exr");
  const std::string options = image.metadata.at("castray:options");
  CHECK_THAT(options, Contains("--look-from 278,273,-700") && Contains("--size 32x24"));
  // its options render it again
  std::vector<std::string> words{"render", CASTRAY_ROOT "/scenes/cornell_box.json", "-q", "-o", "again.exr"};
  std::istringstream in(options);
  for (std::string word; in >> word;) words.push_back(word);
  const RunResult again = run_castray(words, folder.path());
  CAPTURE(again.err);
  REQUIRE(again.exit_code == 0);
  CHECK(run_castray({"compare", "saved.exr", "again.exr", "--max", "relmse=1e-4"}, folder.path()).exit_code ==
        0);
}

TEST_CASE("serve: only the part that is refined gets samples") {
  Served served;
  served.any_frame();
  REQUIRE(served.post("refine", R"({"window": [4, 6, 12, 10]})")->status == 200);
  const json part = served.frame_where([](const json& frame) { return frame.contains("refined"); });
  CHECK(part["refined"] == json({4, 6, 12, 10}));
  const auto pixels = [&](std::uint64_t after) {
    const auto response = served.get("frame?after=" + std::to_string(after));
    std::vector<float> values(response->body.size() / sizeof(float));
    std::memcpy(values.data(), response->body.data(), response->body.size());
    return values;
  };
  const auto first = pixels(part["number"]);
  const json more = served.frame_where(
      [&](const json& frame) { return frame["spp"].get<double>() >= 8 * part["spp"].get<double>(); });
  const auto then = pixels(more["number"]);
  REQUIRE(first.size() == 32 * 24 * 3);
  REQUIRE(then.size() == first.size());
  int changed = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x) {
      const auto at = static_cast<std::size_t>(3 * (32 * y + x));
      const bool inside = x >= 4 && x < 12 && y >= 6 && y < 10;
      if (!inside) CHECK(first[at] == then[at]);
      if (inside && first[at] != then[at]) ++changed;
    }
  CHECK(changed > 16);
  REQUIRE(served.post("refine", R"({"window": null})")->status == 200);
  served.frame_where([](const json& frame) { return !frame.contains("refined"); });
}

TEST_CASE("serve: a paused render gets no samples until it goes on") {
  Served served;
  served.any_frame();
  REQUIRE(served.post("pause", R"({"paused": true})")->status == 200);
  json frame = served.any_frame();
  for (int quiet = 0; quiet < 2;) {  // a pass that was under way may end
    const auto next = served.get("frame?after=" + frame["number"].dump());
    REQUIRE(next);
    if (next->status == 204) break;
    frame = json::parse(next->get_header_value("Castray-Frame"));
    REQUIRE(++quiet < 3);
  }
  const auto before = served.any_frame()["spp"].get<double>();
  REQUIRE(served.post("pause", R"({"paused": false})")->status == 200);
  const json after = served.frame_where([&](const json& f) { return f["spp"] > before; });
  CHECK(after["paused"] == false);
}

TEST_CASE("serve: many at a time get whole frames, while the view changes") {
  Served served;
  std::atomic<int> whole = 0, wrong = 0;
  {
    std::vector<std::jthread> clients;
    for (int i = 0; i < 8; ++i)
      clients.emplace_back([&, i] {
        for (int n = 0; n < 20; ++n) {
          const auto response = i % 4 == 0 ? served.post("look", another_view) : served.get("frame?after=0");
          const bool good =
              response && response->status == 200 && (i % 4 == 0 || response->body.size() % (4 * 12) == 0);
          ++(good ? whole : wrong);
        }
      });
  }
  CHECK(wrong == 0);
  CHECK(whole == 160);
  CHECK(served.end().exit_code == 0);
}

TEST_CASE("serve: a port that is taken, a scene that is broken, or another integrator is an error") {
  Served served;
  const auto run = [](std::vector<std::string> words) {
    words.insert(words.begin(), {"serve", "--size", "8x8"});
    return run_castray(words, RunSettings{.seconds = 60});
  };
  const std::string box = CASTRAY_ROOT "/scenes/cornell_box.json";
  const RunResult taken = run({box, "--port", std::to_string(served.port)});
  CHECK(taken.exit_code == 2);
  CHECK_THAT(taken.err, Contains("--port " + std::to_string(served.port)));
  CHECK(run({"missing.json"}).exit_code == 2);
  CHECK_THAT(run({box, "--checkpoint", "x.film"}).err, Contains("unknown flag '--checkpoint'"));
}
