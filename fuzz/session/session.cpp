// SPDX-License-Identifier: Apache-2.0
// The fuzz target of sessions. Each line of an input is a message, as a window sends it; behind ">" it comes from a second window, which
// may only look, and "-" ends the first window and opens it again. Whatever comes, the session goes on answering, what it sends is JSON
// with "is", its pipeline can be written and read, names no files but its own, and is not changed by who may only look.
#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <mutex>

#include "base/error.h"
#include "base/file/file.h"
#include "base/file/file_fence.h"
#include "base/text/text.h"
#include "checking_renderer.h"
#include "pipeline/picture/picture.h"
#include "serve/session/forbidden.h"
#include "serve/session/session.h"

namespace {

using namespace sg;
using namespace sg::serve;

std::string folder;
std::shared_ptr<LocalRenderer> asked, drawn;
PipelineFile small;

[[noreturn]] void broken(const std::string& promise) {
  std::fprintf(stderr, "ERROR: broken promise: %s\n", promise.c_str());
  std::abort();
}

// Keeps the last message of each kind.
class Wire : public Socket {
 public:
  bool send_text(std::string text) override {
    const Json message = parsed(text);
    const std::lock_guard lock(mutex_);
    last_[message["is"].text()] = message;
    came_.notify_all();
    return true;
  }
  bool send_binary(std::shared_ptr<const std::string> bytes) override {
    size_t head = 0;
    if (bytes->size() < 4) broken("a frame without a header");
    for (size_t i = 0; i < 4; ++i) head |= size_t(uint8_t((*bytes)[i])) << 8 * i;
    if (parsed(bytes->substr(4, head))["is"].text() != "frame") broken("a frame that is none");
    return true;
  }
  size_t waiting() const override { return 0; }
  bool open() const override { return true; }
  void close(std::string) override {}

  Json wait_for(const std::string& is, const std::string& member, uint64_t n) {
    std::unique_lock lock(mutex_);
    if (!came_.wait_for(lock, std::chrono::seconds(60), [&] { return last_[is][member].whole() == n; })) broken("no more " + is);
    return last_[is];
  }

 private:
  static Json parsed(const std::string& text) {
    try {
      Json message = parse_json(text, "message");
      if (!message["is"].is_text()) broken("sends " + text);
      return message;
    } catch (const Error&) {
      broken("sends " + text);
    }
  }
  std::mutex mutex_;
  std::condition_variable came_;
  std::map<std::string, Json> last_;
};

struct Window {
  Window(Session& session, Rights rights) : wire(std::make_shared<Wire>()), handler(session.join(rights, "someone", wire)) {}
  ~Window() { handler.on_close(); }
  std::shared_ptr<Wire> wire;
  SocketHandler handler;
};

// After everything else: 0 to 2^53 is what windows count with.
constexpr uint64_t last = (uint64_t(1) << 53) + 1;

std::string pipeline_text() { return emit_pipeline(small); }

}  // namespace

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  const char* where = std::getenv("TMPDIR");
  folder = fmt::format("{}/sightglass-fuzz-session-{}", where ? where : "/dev/shm", ::getpid());
  std::filesystem::create_directories(folder);
  folder = std::filesystem::canonical(folder).string();
  for (int t = 0; t < 3; ++t)
    write_file(fmt::format("{}/heat_{}.vtk", folder, t),
               "# vtk DataFile Version 3.0\nheat\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 3 3 2\nORIGIN 0 0 0\nSPACING 1 1 1\n"
               "POINT_DATA 18\nSCALARS heat float 1\nLOOKUP_TABLE default\n0 1 2 3 4 5 6 7 8 9 1 2 3 4 5 6 7 8\n");
  small = parse_pipeline("sightglass: 1\nsteps:\n  room: {read: \"" + folder +
                             "/heat_{n}.vtk\"}\n  skin: {contour: {values: 4}, from: room}\nshow:\n"
                             "  - {volume: {opacity: \"0:0,1:0.5\"}, of: room}\n  - {surface: , of: skin}\n",
                         "", picture_vocabulary());
  Context context;
  for (auto* r : {&asked, &drawn}) *r = std::make_shared<LocalRenderer>(16 << 20, std::vector<std::string>{});
  small = asked->load(small, context);
  PipelineFile without_volume = small;  // which takes long with sanitizers
  without_volume.show.erase(without_volume.show.begin());
  drawn->load(without_volume, context);
  FileFence fence;
  fence.read_below = {folder}, fence.who = "a window";
  set_file_fence(std::move(fence));
  std::atexit([] {
    set_file_fence({});
    std::error_code ignored;
    std::filesystem::remove_all(folder, ignored);
  });
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  const std::string_view input(reinterpret_cast<const char*>(bytes), size);
  const auto session =
      Session::open(std::make_unique<fuzz::CheckingRenderer>(asked, drawn, files_read(small), broken), small, "heat_{n}.vtk", folder);
  Window quiet(*session, Rights::edit), looks(*session, Rights::view);
  bool edits = false;
  {
    auto window = std::make_unique<Window>(*session, Rights::edit);
    for (const std::string_view line : split(input, '\n')) {
      if (line == "-") {
        window.reset();
        window = std::make_unique<Window>(*session, Rights::edit);
      } else if (line.starts_with(">")) {
        looks.handler.on_text(line.substr(1));
      } else {
        window->handler.on_text(line), edits = true;
      }
    }
    // Behind all that was asked for.
    quiet.handler.on_text(fmt::format("{{\"do\":\"edit\",\"n\":{},\"edits\":[]}}", last));
    const std::string text = quiet.wire->wait_for("state", "by", last)["pipeline"].text();
    if (!edits && text != pipeline_text()) broken("who may only look changes the pipeline");
    for (const char* what : {"rows", "histogram"}) {
      quiet.handler.on_text(fmt::format(
          "{{\"do\":\"{}\",\"n\":{},\"step\":\"room\",\"field\":\"heat\",\"on\":\"point\",\"from\":0,\"count\":1}}", what, last));
      quiet.wire->wait_for(what, "n", last);
    }
  }
  return 0;
}
