// SPDX-License-Identifier: Apache-2.0
// Small files of ours, cut and damaged: reading them gives data or an Error, never anything else.
#pragma once
#include <algorithm>

#include "io/io_files.h"

namespace sg::test {

/// The file cut at every 1/64th of its length, and with each of its first 200 bytes (and every 1/64th) flipped in turn.
inline void check_survives(const std::string& name, const std::string& bytes) {
  size_t refused = 0, read = 0;
  auto attempt = [&](const std::string& damaged) {
    try {
      for_each_dataset(read_bytes(name, damaged), [](const std::string&, const DatasetPtr& d) { (void)d->bounds(); });
      ++read;
    } catch (const Error& e) {
      if (e.kind() == ErrorKind::internal) FAIL_CHECK(e.what());
      ++refused;
    }
  };
  for (size_t k = 0; k < 64; ++k) attempt(bytes.substr(0, bytes.size() * k / 64));
  const size_t step = std::max<size_t>(bytes.size() / 64, 1);
  for (size_t i = 0; i < bytes.size(); i += i < 200 ? 1 : step)
    for (unsigned char flip : {0x01, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[i] = char(static_cast<unsigned char>(damaged[i]) ^ flip);
      attempt(damaged);
    }
  CHECK(refused > 20);
  CHECK(read > 0);
}

/// Each of the first whole numbers of a text replaced by sizes that no file backs.
inline void check_survives_sizes(const std::string& name, const std::string& text) {
  size_t numbers = 0;
  for (size_t i = 0; i < text.size() && numbers < 60; ++i) {
    const bool begins = std::isdigit(static_cast<unsigned char>(text[i])) &&
                        (i == 0 || std::isspace(static_cast<unsigned char>(text[i - 1])) || text[i - 1] == '=');
    if (!begins) continue;
    size_t end = i;
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
    ++numbers;
    for (const char* size : {"2147483648", "9223372036854775807", "-1", "4294967297", "99999999999999999999"}) {
      std::string damaged = text;
      damaged.replace(i, end - i, size);
      try {
        read_bytes(name, damaged);
      } catch (const Error& e) {
        if (e.kind() == ErrorKind::internal) FAIL_CHECK(e.what());
      }
    }
  }
  CHECK(numbers > 5);
}

}  // namespace sg::test
