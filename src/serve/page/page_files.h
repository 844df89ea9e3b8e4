// SPDX-License-Identifier: Apache-2.0
// The window: the files of web/dist/window/ inside the program, so that an installed program needs no others. cmake/page.cmake puts them
// in.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "serve/http/request.h"

namespace sg::serve {

struct EmbeddedFile {
  std::string_view path;  ///< "assets/window.js"
  std::string_view bytes;
};
/// Those that were there when the program was built; a page that says so when there were none.
std::span<const EmbeddedFile> embedded_files();

/// The answer for "/" (index.html) or "/assets/...": with a sum as its tag, compressed where the browser takes that, 304 where it has it.
/// The browser always asks whether it has changed, since another version of the program may have the same names. Nothing for other paths.
std::optional<HttpResponse> page_answer(const HttpRequest& request);
/// "text/html; charset=utf-8" for "index.html"; "application/octet-stream" for what is unknown.
std::string content_type(std::string_view path);

}  // namespace sg::serve
