// SPDX-License-Identifier: Apache-2.0
#include "serve/guard/token.h"

#include <sys/random.h>

#include <array>
#include <cerrno>

#include "base/error.h"
#include "serve/guard/sha256.h"

namespace sg::serve {

std::string new_token() {
  std::array<unsigned char, 33> random{};  // 33 bytes are 44 letters of 6 bits; 43 of them hold 258 bits
  for (size_t have = 0; have < random.size();) {
    const ssize_t got = ::getrandom(random.data() + have, random.size() - have, 0);
    if (got < 0 && errno != EINTR) fail_internal("the system gives no random numbers");
    if (got > 0) have += size_t(got);
  }
  constexpr std::string_view letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";
  std::string token;
  for (size_t i = 0; i < random.size(); i += 3) {
    const unsigned bits = unsigned(random[i]) << 16 | unsigned(random[i + 1]) << 8 | random[i + 2];
    for (int shift = 18; shift >= 0; shift -= 6) token += letters[bits >> shift & 63];
  }
  token.pop_back();
  return token;
}

std::string token_hash(std::string_view token) { return "sha256:" + sha256_hex(token); }

bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned char differ = 0;  // volatile: no early end
  for (size_t i = 0; i < a.size(); ++i) differ = differ | static_cast<unsigned char>(a[i] ^ b[i]);
  return differ == 0;
}

}  // namespace sg::serve
