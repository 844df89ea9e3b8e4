// SPDX-License-Identifier: Apache-2.0
// Who is let in, to what, and what every answer says: each promise of docs/security.md, "The server", over real connections.
#include <fmt/core.h>
#include <libdeflate.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>

#include "base/file/file.h"
#include "base/text/json.h"
#include "serve/guard/token.h"
#include "serve/page/page_files.h"
#include "serve/support/server.h"
#include "support/test.h"

namespace sg {

using namespace serve;
using test::contains;
using test::Reply;
using test::RunningServer;
using test::Wire;

namespace {

DoorOptions with_folder(const std::string& name) {
  const std::string top = test::fresh_folder(name);
  for (const std::string& folder : {top + "served", top + "secret"}) ::mkdir(folder.c_str(), 0755);
  write_file(top + "served/a.vtk", "# vtk DataFile Version 3.0\n");
  write_file(top + "served/b c.vtk", "# vtk DataFile Version 3.0\n");
  write_file(top + "secret/s.vtk", "# vtk DataFile Version 3.0\n");
  CHECK(::symlink("../secret/s.vtk", (top + "served/link.vtk").c_str()) == 0);
  DoorOptions options;
  options.folder = top + "served";
  return options;
}

int upgraded(const RunningServer& server, const std::string& target, const std::string& more, const std::string& origin) {
  Wire wire(server.port);
  wire.send(server.upgrade(target, more, origin));
  return wire.reply(false).status;
}

}  // namespace

TEST_CASE("door: without a token nothing is to be had, by no path") {
  RunningServer server(with_folder("no_token"));
  for (const char* path :
       {"/", "/index.html", "/assets/a.js", "/catalog.json", "/files.json", "/files.json?below=", "/saved/abc", "/socket", "/none"}) {
    const Reply reply = server.get(path);
    CHECK_MESSAGE(reply.status == 403, path);
    CHECK_MESSAGE(contains(reply.body, "token"), path);
  }
  CHECK(upgraded(server, "/socket?open=a.vtk", "", server.origin()) == 403);
  CHECK(server.host.joined().empty());
}

TEST_CASE("door: a wrong token and a wrong cookie are none; the right one is not used up by them") {
  RunningServer server;
  const std::string token = server.token();
  for (const std::string& wrong : {std::string(), std::string("x"), token.substr(1), token + "x", new_token()}) {
    const Reply reply = server.get("/?token=" + wrong);
    CHECK(reply.status == 403);
    CHECK_FALSE(reply.headers.contains("set-cookie"));
  }
  const std::string name = fmt::format("sightglass_{}", server.port);
  for (const std::string& cookie : {name + "=", name + "=" + token, name + "=" + new_token(), std::string("sightglass=") + token})
    CHECK(server.get("/", "Cookie: " + cookie + "\r\n").status == 403);
  const std::string cookie = server.enter();
  CHECK(server.get("/", cookie).status == 200);
  CHECK(server.get("/?token=" + token).status == 403);          // it has counted
  CHECK(server.get("/?token=" + token, cookie).status == 303);  // for who is in already it does no harm
  CHECK(server.get("/", "Cookie: " + name + "=planted; " + cookie.substr(8)).status == 200);
}

TEST_CASE("door: a token is no token elsewhere than at the door, nor by another method") {
  RunningServer server;
  const std::string token = server.token();
  CHECK(server.get("/catalog.json?token=" + token).status == 403);
  CHECK(upgraded(server, "/socket?token=" + token, "", server.origin()) == 403);
  {
    Wire wire(server.port);
    wire.send(server.request("/?token=" + token, "", "HEAD"));
    CHECK(wire.reply(false).status == 403);
  }
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE", "CONNECT", "PATCH"}) {
    Wire wire(server.port);
    wire.send(server.request("/?token=" + token, "", method));
    CHECK_MESSAGE(wire.reply().status == 405, method);
  }
  CHECK(server.get("/", server.enter()).status == 200);
}

TEST_CASE("door: the cookie is kept from scripts and from other sites; a way that began elsewhere leads to it by a step of its own") {
  RunningServer server;
  const Reply reply = server.get("/?token=" + server.token(), "Sec-Fetch-Site: cross-site\r\n");
  CHECK(reply.status == 200);
  CHECK(contains(reply.body, "content=\"0;url=/\""));
  const std::string cookie = reply.headers.at("set-cookie");
  CHECK(contains(cookie, "; Path=/; HttpOnly; SameSite=Strict"));
  CHECK_FALSE(contains(cookie, "Secure"));
  CHECK_FALSE(contains(cookie, server.token()));
  CHECK(server.get("/", "Sec-Fetch-Site: cross-site\r\n").status == 200);
  CHECK(contains(server.get("/", "Sec-Fetch-Site: cross-site\r\n").body, "url=/"));
}

TEST_CASE("door: asked by a foreign name it answers nothing, whoever asks") {
  RunningServer server;
  const std::string cookie = server.enter();
  for (const std::string& host : {std::string("evil.example"), fmt::format("evil.example:{}", server.port), std::string("127.0.0.1"),
                                  std::string("localhost:1"), fmt::format("127.0.0.1.evil.example:{}", server.port), std::string()}) {
    Wire wire(server.port);
    wire.send("GET / HTTP/1.1\r\nHost: " + host + "\r\n" + cookie + "\r\n");
    CHECK_MESSAGE(wire.reply().status == 403, host);
  }
  {
    Wire wire(server.port);  // no Host at all
    wire.send("GET / HTTP/1.1\r\n" + cookie + "\r\n");
    CHECK(wire.reply().status == 403);
  }
  {
    Wire wire(server.port);
    wire.send(server.request("/", cookie + "Host: evil.example\r\n"));  // a second one
    CHECK(wire.reply().status == 400);
  }
  {
    Wire wire(server.port);
    wire.send(
        fmt::format("GET / HTTP/1.1\r\nHost: evil.example\r\nX-Forwarded-Host: 127.0.0.1:{0}\r\nForwarded: host=127.0.0.1:{0}\r\n{1}\r\n",
                    server.port, cookie));
    CHECK(wire.reply().status == 403);
  }
}

TEST_CASE("door: pages of a foreign origin get nothing; a socket needs ours exactly") {
  RunningServer server;
  const std::string cookie = server.enter(), own = server.origin();
  CHECK(server.get("/catalog.json", cookie + "Origin: " + own + "\r\n").status == 200);
  for (const std::string& origin :
       {std::string("http://evil.example"), std::string("null"), own + "/", fmt::format("https://127.0.0.1:{}", server.port),
        fmt::format("http://localhost:{}", server.port), fmt::format("http://127.0.0.1:{}", server.port - 1)}) {
    CHECK_MESSAGE(server.get("/catalog.json", cookie + "Origin: " + origin + "\r\n").status == 403, origin);
    CHECK_MESSAGE(upgraded(server, "/socket", cookie, origin) == 403, origin);
  }
  CHECK(upgraded(server, "/socket", cookie, "") == 403);
  CHECK(upgraded(server, "/socket", cookie + "Sec-Fetch-Site: cross-site\r\n", own) == 403);
  CHECK(server.get("/catalog.json", cookie + "Sec-Fetch-Site: same-site\r\n").status == 403);
  CHECK(upgraded(server, "/socket", cookie, own) == 101);
  CHECK(server.host.joined().size() == 1);
}

TEST_CASE("door: every answer tells the browser what to refuse") {
  RunningServer server;
  const std::string cookie = server.enter();
  const auto check = [](const Reply& reply) {
    CHECK(reply.headers.at("content-security-policy") ==
          "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob:; connect-src 'self'; font-src 'self'; "
          "base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    CHECK(reply.headers.at("x-content-type-options") == "nosniff");
    CHECK(reply.headers.at("referrer-policy") == "no-referrer");
    CHECK(reply.headers.at("cross-origin-opener-policy") == "same-origin");
    CHECK(reply.headers.at("cross-origin-resource-policy") == "same-origin");
    CHECK(reply.headers.contains("cache-control"));
    CHECK_FALSE(reply.headers.contains("access-control-allow-origin"));
  };
  for (const char* path : {"/", "/catalog.json", "/files.json", "/none", "/socket", "/%"}) check(server.get(path, cookie));
  check(server.get("/"));
  Wire bad(server.port), posted(server.port);
  bad.send("no request\r\n\r\n");
  check(bad.reply());
  posted.send(server.request("/", "", "POST"));
  check(posted.reply());
  Wire socket(server.port);
  socket.send(server.upgrade("/socket", cookie, server.origin()));
  check(socket.reply(false));
}

TEST_CASE("door: the page has no script and no style inside it") {
  RunningServer server;
  const Reply page = server.get("/", server.enter());
  REQUIRE(page.status == 200);
  CHECK(page.headers.at("content-type") == "text/html; charset=utf-8");
  for (size_t at = page.body.find("<script"); at != std::string::npos; at = page.body.find("<script", at + 1)) {
    const std::string tag = page.body.substr(at, page.body.find('>', at) - at);
    CHECK(contains(tag, "src="));
  }
  CHECK_FALSE(contains(page.body, "<style"));
  CHECK_FALSE(contains(page.body, " onclick="));
}

TEST_CASE("door: the files of the page come as they were built in, each with its type, and nothing else does") {
  RunningServer server;
  const std::string cookie = server.enter();
  REQUIRE(!embedded_files().empty());
  for (const EmbeddedFile& file : embedded_files()) {
    const Reply reply = server.get(file.path == "index.html" ? "/" : "/" + std::string(file.path), cookie);
    CHECK(reply.status == 200);
    CHECK(reply.body == file.bytes);
    CHECK(reply.headers.at("content-type") == content_type(file.path));
    CHECK(reply.headers.at("cache-control") == "no-cache");
  }
  for (const char* path : {"/index.html", "/assets", "/assets/", "/assets/none.js", "/assets/index.html", "/etc/passwd"})
    CHECK_MESSAGE(server.get(path, cookie).status == 404, path);
}

TEST_CASE("door: what stays the same is sent once, compressed where that is taken") {
  RunningServer server;
  const std::string cookie = server.enter();
  const Reply plain = server.get("/catalog.json", cookie),
              packed = server.get("/catalog.json", cookie + "Accept-Encoding: br, gzip;q=0.8\r\n");
  CHECK(parse_json(plain.body, "catalog").contains("operations"));
  CHECK(packed.headers.at("content-encoding") == "gzip");
  CHECK(packed.body.size() * 3 < plain.body.size());
  libdeflate_decompressor* unpacker = libdeflate_alloc_decompressor();
  std::string unpacked(plain.body.size(), '\0');
  CHECK(libdeflate_gzip_decompress(unpacker, packed.body.data(), packed.body.size(), unpacked.data(), unpacked.size(), nullptr) ==
        LIBDEFLATE_SUCCESS);
  libdeflate_free_decompressor(unpacker);
  CHECK(unpacked == plain.body);
  CHECK_FALSE(server.get("/catalog.json", cookie + "Accept-Encoding: gzip;q=0\r\n").headers.contains("content-encoding"));
  const Reply again = server.get("/catalog.json", cookie + "If-None-Match: " + plain.headers.at("etag") + "\r\n");
  CHECK(again.status == 304);
  CHECK(again.body.empty());
}

TEST_CASE("door: HEAD tells the length and sends nothing behind it") {
  RunningServer server;
  Wire wire(server.port);
  const std::string cookie = server.enter();
  wire.send(server.request("/", cookie, "HEAD"));
  const Reply head = wire.reply(false);
  CHECK(head.status == 200);
  wire.send(server.request("/", cookie));
  const Reply page = wire.reply();
  CHECK(page.status == 200);
  CHECK(head.headers.at("content-length") == std::to_string(page.body.size()));
}

TEST_CASE("door: no spelling leads out of the served folder") {
  RunningServer server(with_folder("traversal"));
  const std::string cookie = server.enter();
  const std::string spellings[] = {"../secret/s.vtk",
                                   "..%2fsecret%2fs.vtk",
                                   "%2e%2e/secret/s.vtk",
                                   "%2e%2e%2fsecret%2fs.vtk",
                                   "%252e%252e%252fsecret%252fs.vtk",
                                   "..%5csecret%5cs.vtk",
                                   "....//secret/s.vtk",
                                   "./../secret/s.vtk",
                                   "a/../../secret/s.vtk",
                                   "..%c0%afsecret%c0%afs.vtk",
                                   "%c0%ae%c0%ae/secret/s.vtk",
                                   "..%e0%80%afsecret/s.vtk",
                                   "..%00/secret/s.vtk",
                                   "a.vtk%00.png",
                                   "/etc/passwd",
                                   "%2fetc%2fpasswd",
                                   "//etc/passwd",
                                   "file:///etc/passwd",
                                   "..;/secret/s.vtk",
                                   "link.vtk",
                                   "*.vtk",
                                   "a.vtk,../secret/s.vtk",
                                   ".",
                                   ""};
  for (const std::string& name : spellings) {
    const int status = upgraded(server, "/socket?open=" + name, cookie, server.origin());
    CHECK_MESSAGE((status == 404 || status == 400), name);
    if (!name.empty()) {
      const int listed = server.get("/files.json?below=" + name, cookie).status;
      CHECK_MESSAGE((listed == 404 || listed == 400), name);
    }
    const int asset = server.get("/assets/" + name, cookie).status;
    CHECK_MESSAGE((asset == 404 || asset == 400), name);
    const int saved = server.get("/saved/" + name, cookie).status;
    CHECK_MESSAGE((saved == 404 || saved == 400), name);
  }
  CHECK(server.host.joined().empty());
  CHECK(upgraded(server, "/socket?open=b%20c.vtk", cookie, server.origin()) == 101);
  REQUIRE(server.host.joined().size() == 1);
  CHECK(server.host.joined()[0].file.ends_with("/served/b c.vtk"));
  const Reply list = server.get("/files.json?below=", cookie);
  CHECK(list.body ==
        R"({"folders":[],"files":[{"name":"a.vtk","bytes":27,"series":1},{"name":"b c.vtk","bytes":27,"series":1}],"more":false})");
}

TEST_CASE("door: a server of named files opens no others") {
  RunningServer server;
  const std::string cookie = server.enter();
  CHECK(upgraded(server, "/socket?open=a.vtk", cookie, server.origin()) == 404);
  CHECK(server.get("/files.json", cookie).status == 404);
  CHECK(upgraded(server, "/socket", cookie, server.origin()) == 101);
  CHECK(server.host.joined()[0].file.empty());
}

TEST_CASE("door: a window's first message may come with the address of its socket") {
  RunningServer server;
  const std::string cookie = server.enter(), say = "/socket?say=%7B%22do%22%3A%22draw%22%2C%22n%22%3A1%7D";
  CHECK(upgraded(server, say, "", server.origin()) == 403);
  CHECK(upgraded(server, say, cookie, "http://evil.example.org") == 403);
  CHECK(server.host.messages == 0);
  Wire wire = server.socket(cookie, say);
  const auto told = wire.message();
  REQUIRE(told);
  CHECK(told->payload == "{\"do\":\"draw\",\"n\":1}");
  wire.send_frame(test::text_frame, "second");
  CHECK(wire.message()->payload == "second");
}

TEST_CASE("door: each user comes in by a token of its own, with its rights, any number of times") {
  const std::string anna = new_token(), ben = new_token();
  DoorOptions options;
  options.users = parse_users(user_line("anna", Rights::edit, anna) + user_line("ben", Rights::view, ben), "users");
  RunningServer server(options);
  CHECK(server.token().empty());
  CHECK(server.door.address_with_token() == server.origin() + "/");
  server.enter(anna);
  const Wire first = server.socket(server.enter(anna)), second = server.socket(server.enter(ben));
  const auto joined = server.host.joined();
  REQUIRE(joined.size() == 2);
  CHECK(joined[0].user == "anna");
  CHECK(joined[0].rights == Rights::edit);
  CHECK(joined[1].user == "ben");
  CHECK(joined[1].rights == Rights::view);
  CHECK(server.get("/?token=" + new_token()).status == 403);
  CHECK(server.get("/?token=" + token_hash(anna)).status == 403);
}

TEST_CASE("door: behind a proxy its public origin counts, and the cookie is for secure connections alone") {
  DoorOptions options;
  options.public_origins = {"https://view.example.org"};
  RunningServer server(options);
  CHECK(server.door.address() == "https://view.example.org/");
  Wire wire(server.port);
  wire.send("GET /?token=" + server.token() + " HTTP/1.1\r\nHost: view.example.org\r\nX-Forwarded-For: 10.0.0.1\r\n\r\n");
  const Reply reply = wire.reply();
  CHECK(reply.status == 303);
  const std::string set = reply.headers.at("set-cookie");
  CHECK(contains(set, "; Secure"));
  const std::string cookie = "Cookie: " + set.substr(0, set.find(';')) + "\r\n";
  const auto upgrade = [&](const std::string& origin) {
    Wire socket(server.port);
    socket.send("GET /socket HTTP/1.1\r\nHost: view.example.org\r\nOrigin: " + origin + "\r\n" + cookie +
                "Connection: keep-alive, Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
                "dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n");
    return socket.reply(false).status;
  };
  CHECK(upgrade("https://view.example.org") == 101);
  CHECK(upgrade("http://view.example.org") == 403);
  CHECK(upgrade("https://evil.example.org") == 403);
}

TEST_CASE("door: saved pictures are files for the browser to keep, never pages; a full disk is told, and all goes on") {
  RunningServer server;
  const std::string folder = test::fresh_folder("saved");
  server.host.on_saved = [&](const std::string& id) -> std::optional<Saved> {
    if (id == "page") return Saved{"a\"\r\nX: <b>.html", "text/html", std::make_shared<const std::string>("<script>1</script>")};
    if (id != "picture") return {};
    const std::string bytes(100'000, 'x');
    write_file(folder + "picture.png", bytes);
    return Saved{"Kopf \xc3\xbc.png", "image/png", std::make_shared<const std::string>(bytes)};
  };
  const std::string cookie = server.enter();
  const Reply good = server.get("/saved/picture", cookie);
  CHECK(good.status == 200);
  CHECK(good.body == std::string(100'000, 'x'));
  CHECK(good.headers.at("content-type") == "image/png");
  CHECK(good.headers.at("content-disposition") == "attachment; filename=\"Kopf___.png\"; filename*=UTF-8''Kopf%20%C3%BC.png");
  const Reply page = server.get("/saved/page", cookie);
  CHECK(page.headers.at("content-type") == "application/octet-stream");
  CHECK_FALSE(page.headers.contains("x"));
  CHECK(server.get("/saved/none", cookie).status == 404);
  CHECK(server.get("/saved/", cookie).status == 404);
  CHECK(server.get("/saved/" + std::string(65, 'a'), cookie).status == 404);

  // A limit on the size of files stands in for the full disk.
  ::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tight{50'000, before.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &tight);
  const Reply full = server.get("/saved/picture", cookie);
  ::setrlimit(RLIMIT_FSIZE, &before);
  CHECK(full.status == 500);
  CHECK(contains(full.body, "picture.png"));
  CHECK(folder_entries(folder) == std::vector<std::string>{"picture.png"});
  CHECK(server.get("/saved/picture", cookie).status == 200);
}

}  // namespace sg
