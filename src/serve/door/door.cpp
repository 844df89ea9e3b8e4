// SPDX-License-Identifier: Apache-2.0
#include "serve/door/door.h"

#include <fmt/core.h>

#include "base/error.h"
#include "base/text/text.h"
#include "serve/door/catalog_text.h"
#include "serve/door/safe_headers.h"
#include "serve/files/served_folder.h"
#include "serve/guard/host_check.h"
#include "serve/guard/visitors.h"
#include "serve/http/target.h"
#include "serve/page/page_files.h"
#include "serve/page/static_body.h"

namespace sg::serve {

namespace {

HttpResponse told(int status, std::string text) { return {status, "text/plain; charset=utf-8", {}, std::move(text) + "\n", nullptr}; }

HttpResponse json(std::string text) { return {200, "application/json", {}, std::move(text), nullptr}; }

// Leads to the window by a step of its own page: a cookie for this site alone is not sent along a way that began at another one.
HttpResponse leads_to_window(const std::string& window) {
  return {200,
          "text/html; charset=utf-8",
          {},
          fmt::format("<!doctype html><html lang=\"en\"><meta http-equiv=\"refresh\" content=\"0;url={0}\"><title>Sightglass</title><p><a "
                      "href=\"{0}\">Go on</a></html>\n",
                      window),
          nullptr};
}

bool comes_from_elsewhere(const HttpRequest& request) { return request.fetch_site == "cross-site" || request.fetch_site == "same-site"; }

bool is_saved_id(std::string_view id) {
  return !id.empty() && id.size() <= 64 &&
         id.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_") == id.npos;
}

// A name in both forms of RFC 6266: letters that need no escape, and UTF-8.
std::string as_attachment(const std::string& name) {
  std::string plain, escaped;
  for (const char c : name.substr(0, 200)) {
    const bool easy = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '_';
    plain += easy ? c : '_';
    escaped += easy ? std::string(1, c) : fmt::format("%{:02X}", unsigned(static_cast<unsigned char>(c)));
  }
  return fmt::format("attachment; filename=\"{}\"; filename*=UTF-8''{}", plain, escaped);
}

}  // namespace

struct Door::Inside {
  Inside(const DoorOptions& options, SessionHost& sessions)
      : host(sessions),
        visitors(options.users),
        folder(options.folder.empty() ? nullptr : std::make_unique<ServedFolder>(options.folder)),
        server(with_headers(options.server), {[this](const HttpRequest& r) { return answer(r); },
                                              [this](const HttpRequest& r, std::shared_ptr<Socket> socket, HttpResponse& refusal) {
                                                return open(r, std::move(socket), refusal);
                                              }}),
        hosts(options.server.address, server.port(), options.public_origins),
        cookie(fmt::format("sightglass_{}", server.port())) {}

  static ServerOptions with_headers(ServerOptions options) {
    options.headers = safe_headers();
    return options;
  }

  std::optional<Visitor> visitor_of(const HttpRequest& request) const {
    for (const std::string_view secret : cookie_values(request.cookie, cookie))
      if (auto visitor = visitors.visitor(secret)) return visitor;
    return {};
  }

  // Nothing when the request may go on.
  std::optional<HttpResponse> wrong_way(const HttpRequest& request, bool needs_origin) const {
    if (!hosts.origin_of(request.host))
      return told(403, fmt::format("This server is not called '{}'. Behind a proxy it has to be told by which address it is reached.",
                                   request.host.substr(0, 200)));
    if ((needs_origin || !request.origin.empty()) && !hosts.is_ours(request.host, request.origin))
      return told(403, "A page of another server may ask nothing here.");
    if (comes_from_elsewhere(request) && request.path != "/") return told(403, "A page of another server may ask nothing here.");
    return {};
  }

  HttpResponse stranger() const {
    return told(
        403, visitors.token().empty()
                 ? "This needs your token: open the address with ?token=... that you were given."
                 : "This needs a token: open the address that sightglass printed. It counts once; start sightglass again for another one.");
  }

  // The window of the session, or the list of files to choose from.
  std::string window() const { return folder ? "/?below=" : "/"; }

  HttpResponse enter(const HttpRequest& request, const std::string& token) {
    if (request.method != "GET") return stranger();
    const auto secret = visitors.enter(token);
    HttpResponse response = leads_to_window(window());
    if (!comes_from_elsewhere(request)) {
      response = told(303, "");
      response.headers.emplace_back("Location", window());
    }
    if (!secret) return visitor_of(request) ? response : stranger();
    const bool secure = hosts.origin_of(request.host)->starts_with("https:");
    response.headers.emplace_back("Set-Cookie",
                                  fmt::format("{}={}; Path=/; HttpOnly; SameSite=Strict{}", cookie, *secret, secure ? "; Secure" : ""));
    return response;
  }

  HttpResponse files(const HttpRequest& request) const {
    if (!folder) return told(404, "This server has no folder of files; what it shows was named when it was started.");
    const std::string* below = request.word("below");
    try {
      return json(folder->list_json(below ? *below : ""));
    } catch (const Error& e) {
      return told(404, e.what());
    }
  }

  HttpResponse saved(const HttpRequest& request) {
    const std::string id = request.path.substr(std::string_view("/saved/").size());
    const auto picture = is_saved_id(id) ? host.saved(id) : std::nullopt;
    if (!picture || !picture->bytes) return told(404, "There is no such picture; save it again.");
    const bool known = picture->type == "image/png" || picture->type == "image/jpeg" || picture->type == "image/webp";
    HttpResponse response;
    response.type = known ? picture->type : "application/octet-stream";
    response.headers = {{"Content-Disposition", as_attachment(picture->name)}};
    response.shared_body = picture->bytes;
    return response;
  }

  HttpResponse answer(const HttpRequest& request) {
    if (auto refusal = wrong_way(request, false)) return *refusal;
    if (const std::string* token = request.word("token"); token && request.path == "/") return enter(request, *token);
    if (!visitor_of(request)) return request.path == "/" && comes_from_elsewhere(request) ? leads_to_window(window()) : stranger();
    if (request.path == "/catalog.json") {
      if (!catalog_body) catalog_body = std::make_unique<StaticBody>(catalog_text(), "application/json");
      return catalog_body->answer(request, "no-cache");
    }
    if (request.path == "/files.json") return files(request);
    if (request.path.starts_with("/saved/")) return saved(request);
    if (request.path == "/socket") return told(426, "This is the address of a WebSocket.");
    if (auto page = page_answer(request)) return *page;
    return told(404, "There is nothing at this address.");
  }

  std::optional<SocketHandler> open(const HttpRequest& request, std::shared_ptr<Socket> socket, HttpResponse& refusal) {
    const auto refuse = [&](HttpResponse why) {
      refusal = std::move(why);
      return std::nullopt;
    };
    if (auto wrong = wrong_way(request, true)) return refuse(*wrong);
    const auto visitor = visitor_of(request);
    if (!visitor) return refuse(stranger());
    if (request.path != "/socket") return refuse(told(404, "The WebSocket is at /socket."));
    const std::string* name = request.word("open");
    std::string file;
    if (folder) {
      if (!name || name->empty()) return refuse(told(404, "No file is named: /socket?open=FILE."));
      try {
        file = folder->to_open(*name);
      } catch (const Error& e) {
        return refuse(told(404, e.what()));
      }
    } else if (name && !name->empty()) {
      return refuse(told(404, "This server shows what was named when it was started, no other files."));
    }
    refusal = told(503, "There are too many sessions at this server; close one of them.");
    auto handler = host.join(file, visitor->rights, visitor->user, std::move(socket));
    // What the window says first need not wait until the browser has opened the socket.
    if (const std::string* first = request.word("say"); handler && first) handler->on_text(*first);
    return handler;
  }

  SessionHost& host;
  Visitors visitors;
  std::unique_ptr<ServedFolder> folder;
  std::unique_ptr<StaticBody> catalog_body;  // of the thread of the handlers
  Server server;
  HostCheck hosts;
  std::string cookie;
};

Door::Door(const DoorOptions& options, SessionHost& host) : inside_(std::make_unique<Inside>(options, host)) {}
Door::~Door() = default;

uint16_t Door::port() const { return inside_->server.port(); }
std::string Door::address() const { return inside_->hosts.origins().front() + "/"; }
std::string Door::address_with_token() const {
  const std::string& token = inside_->visitors.token();
  return token.empty() ? address() : address() + "?token=" + token;
}
void Door::run(const Context& context) { inside_->server.run(context); }
void Door::stop() { inside_->server.stop(); }
size_t Door::connections() const { return inside_->server.connections(); }
size_t Door::sockets() const { return inside_->server.sockets(); }

}  // namespace sg::serve
