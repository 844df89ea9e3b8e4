// SPDX-License-Identifier: Apache-2.0
#include "serve/page/static_body.h"

#include <libdeflate.h>

#include "base/text/text.h"
#include "serve/guard/sha256.h"

namespace sg::serve {

namespace {

std::shared_ptr<const std::string> gzip_packed(std::string_view bytes) {
  const std::unique_ptr<libdeflate_compressor, void (*)(libdeflate_compressor*)> packer(libdeflate_alloc_compressor(9),
                                                                                        libdeflate_free_compressor);
  if (!packer) return nullptr;
  std::string out(libdeflate_gzip_compress_bound(packer.get(), bytes.size()), '\0');
  out.resize(libdeflate_gzip_compress(packer.get(), bytes.data(), bytes.size(), out.data(), out.size()));
  return out.empty() || out.size() >= bytes.size() ? nullptr : std::make_shared<const std::string>(std::move(out));
}

bool takes_gzip(const std::string& accept_encoding) {
  for (const std::string_view coding : split(accept_encoding, ',')) {
    const auto parts = split(coding, ';');
    if (parts.empty() || !equal_ignoring_case(parts[0], "gzip")) continue;
    return parts.size() < 2 || !parts[1].starts_with("q=0") || parts[1].find_first_of("123456789") != std::string_view::npos;
  }
  return false;
}

}  // namespace

StaticBody::StaticBody(std::string bytes, std::string type)
    : type_(std::move(type)), tag_("\"" + sha256_hex(bytes).substr(0, 32) + "\""), packed_(gzip_packed(bytes)) {
  plain_ = std::make_shared<const std::string>(std::move(bytes));
}

HttpResponse StaticBody::answer(const HttpRequest& request, const char* cache) const {
  HttpResponse response;
  response.type = type_;
  response.headers = {{"ETag", tag_}, {"Vary", "Accept-Encoding"}, {"Cache-Control", cache}};
  if (request.if_none_match == tag_) {
    response.status = 304;
    return response;
  }
  const bool packed = packed_ && takes_gzip(request.accept_encoding);
  response.shared_body = packed ? packed_ : plain_;
  if (packed) response.headers.emplace_back("Content-Encoding", "gzip");
  return response;
}

}  // namespace sg::serve
