// SPDX-License-Identifier: Apache-2.0
#include "serve/page/page_files.h"

#include <array>
#include <map>
#include <mutex>

#include "serve/page/static_body.h"

namespace sg::serve {

namespace {

// Each is prepared when it is asked for first.
const StaticBody* prepared(std::string_view path) {
  static std::mutex mutex;
  static std::map<std::string_view, StaticBody> all;
  const std::lock_guard lock(mutex);
  if (const auto found = all.find(path); found != all.end()) return &found->second;
  for (const EmbeddedFile& file : embedded_files())
    if (file.path == path) return &all.emplace(file.path, StaticBody(std::string(file.bytes), content_type(path))).first->second;
  return nullptr;
}

}  // namespace

std::string content_type(std::string_view path) {
  constexpr std::array<std::pair<std::string_view, const char*>, 12> types{{{".html", "text/html; charset=utf-8"},
                                                                            {".js", "text/javascript; charset=utf-8"},
                                                                            {".css", "text/css; charset=utf-8"},
                                                                            {".json", "application/json"},
                                                                            {".svg", "image/svg+xml"},
                                                                            {".png", "image/png"},
                                                                            {".ico", "image/x-icon"},
                                                                            {".webp", "image/webp"},
                                                                            {".woff2", "font/woff2"},
                                                                            {".wasm", "application/wasm"},
                                                                            {".txt", "text/plain; charset=utf-8"},
                                                                            {".map", "application/json"}}};
  for (const auto& [end, type] : types)
    if (path.ends_with(end)) return type;
  return "application/octet-stream";
}

std::optional<HttpResponse> page_answer(const HttpRequest& request) {
  const bool asset = request.path.starts_with("/assets/");
  const std::string path = request.path == "/" ? "index.html" : asset ? request.path.substr(1) : "";
  const StaticBody* file = path.empty() ? nullptr : prepared(path);
  if (!file) return {};
  return file->answer(request, "no-cache");
}

}  // namespace sg::serve
